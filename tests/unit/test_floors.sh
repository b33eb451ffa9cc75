#!/usr/bin/env bash
# The floors: no file under src/<floor>/ includes a header of a floor that it may not use, the engines know no Lua,
# screen, database or file, and no source file is longer than 800 lines. Usage: test_floors.sh PROJECT
set -euo pipefail
cd "${1:-.}/src"

declare -A may_use=(
    [base]=""
    [geom]="base"
    [effect]="base"
    [solid]="base geom effect"
    [sheet]="base geom effect"
    [sim]="base geom effect solid sheet"
    [store]="base"
    [script]="base geom effect sim"
    [view]="base"
    [session]="base geom effect sim store script view"
    [study]="base geom effect sim store script session"
    [tui]="base geom effect solid sheet sim store script view session study"
    [cli]="base geom effect solid sheet sim store script view session study tui"
)
readonly line_limit=800
readonly foreign_headers='lua|lauxlib|lualib|luaconf|n?curses|panel|sqlite3|hdf5'
# <stdio.h> is allowed for snprintf: what prints or opens files is not.
readonly file_calls='FILE|f(d|re)?open|fwrite|f?puts|f?putc|putchar|v?[fd]?printf|perror'

failures=0
fail() {
    echo "$*"
    failures=$((failures + 1))
}

# Lines "file:number:header" of every include of FOLDER, of both kinds: "x.h" and <x.h>.
includes_of() {
    grep -rnE '^[[:space:]]*#[[:space:]]*include[[:space:]]*[<"]' --include='*.[ch]' "$1" |
        sed -E 's/^([^:]*:[0-9]+):[^<"]*[<"]([^>"]*)[>"].*/\1:\2/' || true
}

# check_include FLOOR FILE LINE HEADER
check_include() {
    local floor=$1 file=$2 line=$3 header=$4 target=${4%%/*}
    case $header in
    *../*)
        fail "$file:$line: includes $header: headers are named from src/, as in \"base/memory.h\""
        return
        ;;
    */*) ;;
    *) target=$floor ;; # a system header, or a neighbour's
    esac
    [[ -v may_use[$target] ]] || return 0
    [[ $target == "$floor" || " ${may_use[$floor]} " == *" $target "* ]] && return
    fail "$file:$line: $floor includes $header, but may use only: ${may_use[$floor]:-nothing}"
}

included=0
for folder in */; do
    floor=${folder%/}
    if [[ ! -v may_use[$floor] ]]; then
        fail "src/$floor: not a floor that this test knows"
        continue
    fi
    while IFS=: read -r file line header; do
        included=$((included + 1))
        check_include "$floor" "$file" "$line" "$header"
    done < <(includes_of "$floor")
done
[[ $included -gt 0 ]] || fail "no include was found: is this the project's folder?"

for floor in solid sheet; do
    [[ -d $floor ]] || continue
    while IFS=: read -r file line header; do
        [[ $header =~ ^(.*/)?($foreign_headers)[A-Za-z0-9_]*\.h$ ]] || continue
        fail "$file:$line: the engines do not include $header"
    done < <(includes_of "$floor")
    while IFS= read -r call; do
        fail "$call: the engines neither print nor write files"
    done < <(grep -rnoE --include='*.[ch]' "(^|[^A-Za-z0-9_])($file_calls)[[:space:]]*[(*]" "$floor" || true)
done

while read -r lines file; do
    [[ $lines -le $line_limit ]] || fail "src/$file has $lines lines: more than $line_limit"
done < <(find . -type f -name '*.[ch]' -printf '%P\n' | while IFS= read -r file; do
    echo "$(wc -l <"$file") $file"
done)

echo "$included includes, $failures failed"
[[ $failures -eq 0 ]]
