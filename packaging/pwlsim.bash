# Completion of pwlsim for bash.

_pwlsim() {
  local current=$2 previous=$3 command= word
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    case $word in
      inspect | export | compare) command=$word && break ;;
    esac
  done
  case $previous in
    --engine) mapfile -t COMPREPLY < <(compgen -W "auto exact modes krylov sparse" -- "$current") && return ;;
    --format) mapfile -t COMPREPLY < <(compgen -W "csv raw" -- "$current") && return ;;
    --reltol | --smooth | --budget | --mode | --jobs) COMPREPLY=() && return ;;
  esac
  if [[ $current == -* ]]; then
    local options
    case $command in
      inspect) options="--help --mode --json --quiet" ;;
      export) options="--help --output --smooth --quiet" ;;
      compare) options="--help --budget --verbose --no-progress --smooth --json --plot --quiet" ;;
      *) options="--help --version --output --events --engine --reltol --stats --format --split --no-rows --jobs --plot --report --check --json --quiet --verbose --no-progress" ;;
    esac
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
    [[ $COMP_CWORD -eq 1 ]] && mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -W "inspect export compare" -- "$current")
  fi
}

complete -o filenames -F _pwlsim pwlsim
