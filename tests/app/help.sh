# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# Help, the manual and exit codes agree with the code.
# Read by tests/app.sh, whose functions it calls.

# Help and exit codes
exits 'help' 0 help
is 'help names every command' sh -c 'for c in run plan audit render ccd \
    convert pattern sew untangle export view sweep fetch-models materials info help; do grep -q "^  $c " out || exit 1; done'
for command in run plan audit render ccd convert pattern sew untangle export view sweep fetch-models \
    materials info help; do
    exits "help $command" 0 help $command
    is "help $command shows its usage" grep -q "usage: drape $command" out
done
for command in run plan audit render ccd convert pattern sew untangle export view sweep \
    fetch-models; do
    refused "$command --nonsense" '--nonsense: unknown option' \
        $command --nonsense
done
exits 'help after other arguments' 0 run none.json --help
is 'it is the command'"'"'s' grep -q 'usage: drape run' out
"$drape" run --help >run.txt
exits 'help by -h' 0 -h
is 'is help' sh -c '"$0" help | cmp - out' "$drape"
exits 'help of a command by -h, wherever' 0 run none.json -h
is 'is its help' cmp out run.txt
refused 'no help behind --' '--help: No such file' run -- --help
refused 'nor by a value' '--helpx: unknown option' run --helpx
if command -v groff >/dev/null; then
    is 'groff understands the manual' sh -c \
        'groff -ww -man -Tutf8 -z "$0" 2>&1 | tee bad && ! [ -s bad ]' "$root/app/drape.1"
else
    skip 'groff reads the manual: there is no groff'
fi
# Every option in a command's table is in its help and in the manual.
for command in run plan audit render ccd convert pattern sew untangle; do
    "$drape" help $command >out
    sed 's/\\-/-/g' "$root/app/drape.1" >manual
    options=$(sed -n 's/.*_OPTION("\(--[a-z-]*\)",.*/\1/p' \
        "$root/app/tool/$command.c")
    is "$command has options" test -n "$options"
    for o in $options; do
        is "help and manual have $command $o" sh -c \
            'grep -qe "$1" out && grep -qe "$1" manual' sh "$o"
    done
done
exits 'run --help' 0 run --help
exits 'info' 0 info
exits 'no command' 2
is 'which is told the commands' grep -q '^  run  ' err
refused 'unknown command' 'frobnicate' frobnicate
refused 'unknown option' '--frob' run tiny.json --frob
refused 'option without value' '--frames' run tiny.json --frames
refused 'option out of range' '--frames' run tiny.json --frames -1
refused 'option no number' '--threads' run tiny.json --threads two
refused 'option that goes on' '--threads 2x: expected a whole number' \
    run tiny.json --threads 2x
refused 'option of nothing' '--threads  : expected a whole number' \
    run tiny.json --threads ' '
refused 'no scene' 'expected one' run
refused 'two scenes' 'expected one' run tiny.json tiny.json
refused 'precision 33' 'precision' run tiny.json --precision 33 --out refused
refused 'unknown backend' '--backend' run tiny.json --backend abacus
refused 'blocks of no whole warps' 'tiny.json: block is 33, expected a multiple' \
    run tiny.json --block 33 --out refused
# Whole numbers from the least to the greatest, and no other.
while read -r command option least most; do
    for n in $((least - 1)) $((most + 1)); do
        refused "$command $option $n" "$option $n: expected a whole number from $(
            )$least to $most" $command nowhere $option $n
    done
    for n in $least $most; do
        "$drape" $command nowhere $option $n >out 2>err
        is "$command $option $n" sh -c '! grep -e "$0" err' "$option"
    done
done <<'EOF'
run --frames 0 1000000
run --threads 0 4096
run --block 0 256
run --every 1 1000000
run --checkpoint-every 1 1000000
render --frame 0 1000000
render --every 1 1000000
render --turn 1 100000
render --width 16 16384
render --height 16 16384
render --samples 1 65536
render --threads 0 256
render --rate 1 1000
export --every 1 1000000
view --port 0 65535
EOF
