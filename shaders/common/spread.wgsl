// Work spread over a dispatch. Drivers that run on a CPU give each core one stretch of workgroups, but there may be less to do than
// was dispatched, and what is near in memory takes about as long. So each of the dispatch's SPREAD_PARTS parts gets as many chunks
// of 64, and parts that follow each other are far apart.

const SPREAD_NONE: u32 = 0xffffffffu;

// What an invocation treats of `count`; beyond the count there is nothing. There are SPREAD_PARTS workgroups or a multiple.
fn spread_number(invocation: u32, groups: u32, count: u32) -> u32 {
    let each = groups / SPREAD_PARTS;
    let chunks = (count + 64u * SPREAD_PARTS - 1u) / (64u * SPREAD_PARTS);
    let group = invocation / 64u;
    let part = reverseBits(group / each) >> (32u - firstTrailingBit(SPREAD_PARTS));
    let place = group % each;
    return select(SPREAD_NONE, (part * chunks + place) * 64u + invocation % 64u, place < chunks);
}
