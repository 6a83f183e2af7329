# Completion of kluft's subcommands and options for bash.

_kluft() {
    local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
    local commands="run check schema draw report compare envelope study calibrate validate"
    COMPREPLY=()

    local command="" index
    for ((index = 1; index < COMP_CWORD; ++index)); do
        if [[ " $commands " == *" ${COMP_WORDS[index]} "* ]]; then
            command=${COMP_WORDS[index]}
            break
        fi
    done

    if [[ -z $command ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$commands --help --version" -- "$word")
        return
    fi

    case "$previous" in
    --set | --threads | --mark | --limit | --title | --compare | --tension | --tolerance | --jobs | --scale | --window) return ;;
    --step)
        mapfile -t COMPREPLY < <(compgen -W "peak last" -- "$word")
        return
        ;;
    --field)
        mapfile -t COMPREPLY < <(compgen -W "sigma_1 sigma_3 stress_xx stress_yy stress_xy stress_zz displacement displacement_x displacement_y" -- "$word")
        return
        ;;
    --emit)
        mapfile -t COMPREPLY < <(compgen -W "slurm make" -- "$word")
        return
        ;;
    -o | --output)
        mapfile -t COMPREPLY < <(compgen -f -- "$word")
        return
        ;;
    esac

    local options="--help"
    case "$command" in
    run) options+=" -o --output --set --threads --quiet --resume --force" ;;
    check) options+=" --set --json" ;;
    draw) options+=" -o --output --curve --blocks --histories --step --field --scale --window --mark --limit --title --set" ;;
    report) options+="" ;;
    compare) options+=" -o --output --tolerance" ;;
    envelope) options+=" -o --output --tension --compare --title" ;;
    study) options+=" -o --output --jobs --set --emit --collect --quantity --quiet" ;;
    calibrate) options+=" -o --output --jobs --quiet" ;;
    validate) options+=" -o --output --jobs --list" ;;
    esac
    if [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
        return
    fi

    case "$command" in
    schema) mapfile -t COMPREPLY < <(compgen -W "scene study calibration" -- "$word") ;;
    run | check | draw | calibrate) _kluft_scenes "$word" ;;
    study)
        _kluft_scenes "$word"
        mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -W "step-size trade" -- "$word")
        ;;
    envelope)
        mapfile -t COMPREPLY < <(
            compgen -d -- "$word"
            compgen -f -X "!*.csv" -- "$word"
        )
        ;;
    compare | report) mapfile -t COMPREPLY < <(compgen -d -- "$word") ;;
    esac
}

# Scene files, and folders on the way to them.
_kluft_scenes() {
    mapfile -t COMPREPLY < <(
        compgen -d -- "$1"
        for ending in yaml yml json; do compgen -f -X "!*.$ending" -- "$1"; done
    )
}

complete -o filenames -F _kluft kluft
