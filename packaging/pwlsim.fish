# Completion of pwlsim for fish.

function __pwlsim_has
    __fish_seen_subcommand_from $argv
end

complete -c pwlsim -n 'not __pwlsim_has inspect export compare' -a 'inspect export compare'
complete -c pwlsim -s h -l help -d 'Print the options and stop'
complete -c pwlsim -l quiet -d 'Print only errors'

set -l run 'not __pwlsim_has inspect export compare'
complete -c pwlsim -n $run -l version -d 'Print the version and stop'
complete -c pwlsim -n "$run; or __pwlsim_has export" -s o -l output -r -F -d 'The file of rows, or of the deck'
complete -c pwlsim -n $run -l events -d 'A row before and after every event'
complete -c pwlsim -n $run -l engine -x -a 'auto exact modes krylov sparse' -d 'Which engine'
complete -c pwlsim -n $run -l reltol -x -d 'Bound on the local error of the sparse engine'
complete -c pwlsim -n $run -l stats -r -F -d 'Statistics as JSON'
complete -c pwlsim -n $run -l format -x -a 'csv raw' -d 'Format of the rows'
complete -c pwlsim -n $run -l split -d 'One file for each run of .step'
complete -c pwlsim -n $run -l no-rows -d 'Write no rows'
complete -c pwlsim -n $run -l jobs -x -d 'Number of .step runs at a time'
complete -c pwlsim -n "$run; or __pwlsim_has compare" -l plot -r -F -d 'Draw the waveforms'
complete -c pwlsim -n $run -l report -r -F -d 'Write a web page'
complete -c pwlsim -n $run -l check -d 'Run the other engine too'
complete -c pwlsim -n "$run; or __pwlsim_has inspect compare" -l json -d 'Print a JSON summary'
complete -c pwlsim -n $run -l verbose -d 'Print run times and counts'
complete -c pwlsim -n $run -l no-progress -d 'No progress bar'
complete -c pwlsim -n '__pwlsim_has inspect' -l mode -x -d 'Diodes and switches that are on or off'
complete -c pwlsim -n '__pwlsim_has export compare' -l smooth -x -d 'Sharpness of the smoothed elements'
complete -c pwlsim -n '__pwlsim_has compare' -l budget -x -d 'Seconds that ngspice may take'
