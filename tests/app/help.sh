# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# Help, the manual and exit codes agree with the code.
# Read by tests/app.sh, whose functions it calls.

# Help and exit codes
exits 'help' 0 help
is 'help names every command' sh -c 'for c in run plan audit render ccd \
    convert export view fetch-models materials info help; do grep -q "^  $c " out || exit 1; done'
for command in run plan audit render ccd convert export view fetch-models \
    materials info help; do
    exits "help $command" 0 help $command
    is "help $command shows its usage" grep -q "usage: drape $command" out
done
for command in run plan audit render ccd convert export view fetch-models; do
    refused "$command --nonsense" '--nonsense: unknown option' \
        $command --nonsense
done
exits 'help after other arguments' 0 run none.json --help
is 'it is the command'"'"'s' grep -q 'usage: drape run' out
# Every option in a command's table is in its help and in the manual.
for command in run plan audit render ccd convert; do
    "$drape" help $command >out
    sed 's/\\-/-/g' "$root/app/drape.1" >manual
    options=$(sed -n 's/.*{"\(--[a-z-]*\)", OPTION.*/\1/p' \
        "$root/app/$command.c")
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
refused 'no scene' 'expected one' run
refused 'two scenes' 'expected one' run tiny.json tiny.json
refused 'precision 33' 'precision' run tiny.json --precision 33 --out refused
refused 'unknown backend' '--backend' run tiny.json --backend abacus
refused 'blocks of no whole warps' 'tiny.json: block is 33, expected a multiple' \
    run tiny.json --block 33 --out refused
