// The settings of the hair that is shaded, where the hairs of a frame differ in them: by the bits behind its tables' place. Where
// they do not, constants have these names.

var<private> FIBRE_TABLES: bool;
var<private> FIBRE_TABLE_F16: bool;
var<private> FIBRE_DUAL: bool;
var<private> MARSCHNER_ELLIPTIC: bool;
var<private> MARSCHNER_CUBIC: bool;
var<private> NEAR: bool;

fn settings_begin() {
    let bits = bitcast<u32>(material_value(15u).w);
    FIBRE_TABLES = (bits & 1u) != 0u;
    FIBRE_TABLE_F16 = (bits & 2u) != 0u;
    FIBRE_DUAL = (bits & 4u) != 0u;
    MARSCHNER_ELLIPTIC = (bits & 8u) != 0u;
    MARSCHNER_CUBIC = (bits & 16u) != 0u;
    NEAR = (bits & 32u) != 0u;
}
