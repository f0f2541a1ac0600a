#!/usr/bin/env bash
# Installs the shared library that lies in the folder FROM, its headers, and what pkg-config and CMake need to find them.
# `make install` calls it, with PREFIX, LIBDIR, INCLUDEDIR and DESTDIR as everywhere: DESTDIR is put before every path that is
# written to, and is no part of any path that is written down.
set -euo pipefail
cd "$(dirname "$0")/.."

for name in PREFIX LIBDIR INCLUDEDIR; do
    case "${!name:?}" in
    /*) ;;
    *) echo "$name is ${!name}, which is not an absolute path." >&2 && exit 1 ;;
    esac
done

VERSION=$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"/\1/p' Cargo.toml)
MINOR_VERSION=${VERSION%.*}
ABI=$(sed -n 's/^#define PELAGE_ABI_VERSION //p' include/pelage.h)
case "$(uname -s)" in
Darwin) BUILT=libpelage.dylib SONAME=@rpath/libpelage.$ABI.dylib LIBRARY=libpelage.$ABI.dylib ALIAS=libpelage.dylib ;;
*) BUILT=libpelage.so SONAME=libpelage.so.$ABI LIBRARY=libpelage.so.$VERSION ALIAS=libpelage.so ;;
esac
if [ ! -f "$FROM/$BUILT" ]; then
    echo "$FROM/$BUILT is not there; cargo build makes it." >&2
    exit 1
fi

# Fills in a template of packaging/.
fill() {
    sed -e "s|@PREFIX@|$PREFIX|g; s|@LIBDIR@|$LIBDIR|g; s|@INCLUDEDIR@|$INCLUDEDIR|g; s|@VERSION@|$VERSION|g" \
        -e "s|@MINOR_VERSION@|$MINOR_VERSION|g; s|@LIBRARY@|$LIBRARY|g; s|@SONAME@|$SONAME|g" "packaging/$1" >"$2"
    chmod 644 "$2"
}

lib=${DESTDIR:-}$LIBDIR
include=${DESTDIR:-}$INCLUDEDIR
mkdir -p "$lib/pkgconfig" "$lib/cmake/pelage" "$include"
# A name of its own first: a program that runs on the old library keeps it.
cp "$FROM/$BUILT" "$lib/.$LIBRARY.new"
chmod 755 "$lib/.$LIBRARY.new"
mv -f "$lib/.$LIBRARY.new" "$lib/$LIBRARY"
[ "$LIBRARY" = "${SONAME#@rpath/}" ] || ln -sf "$LIBRARY" "$lib/$SONAME"
ln -sf "${SONAME#@rpath/}" "$lib/$ALIAS"
for header in pelage.h pelage.hpp; do
    cp "include/$header" "$include/$header"
    chmod 644 "$include/$header"
done
fill pelage.pc.in "$lib/pkgconfig/pelage.pc"
fill pelageConfig.cmake.in "$lib/cmake/pelage/pelageConfig.cmake"
fill pelageConfigVersion.cmake.in "$lib/cmake/pelage/pelageConfigVersion.cmake"
echo "installed pelage $VERSION below ${DESTDIR:-}$PREFIX"
