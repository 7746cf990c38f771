# Wine with what the programs need of the system; sourced, with the folder of everything built for Windows in $target.
export WINEPREFIX=$target/wine WINEDEBUG=${WINEDEBUG:--all}
wine() { /usr/lib/wine/wine64 "$@"; }
prepare_wine() {
    if [ ! -e "$WINEPREFIX/system.reg" ]; then wine wineboot -i >/dev/null 2>&1; fi
    x86_64-w64-mingw32-gcc -O2 -shared -o "$WINEPREFIX/drive_c/windows/system32/bcryptprimitives.dll" \
        "$1/wine_bcryptprimitives.c" -ladvapi32
}
