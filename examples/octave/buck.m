% A buck converter from Octave: a run, its waveforms, and a sweep. pwlsim_run.c says how the function is built.
%
%     octave-cli buck.m
%
% The output voltage stands beside duty times input (Erickson and Maksimovic, Fundamentals of Power Electronics, chapter 2).

deck = strjoin ({
  "buck"
  "V1 in 0 24"
  "VG gate 0 PULSE(0 1 0 0 0 {duty*10u} 10u)"
  "S1 in sw gate 0 ideal"
  ".model ideal SW(Vt=0.5)"
  "D1 0 sw diode"
  ".model diode D"
  "L1 sw out 47u"
  "C1 out 0 100u"
  "R1 out 0 2.5"
  ".param duty=0.45"
  ".save v(out) i(L1)"
  ".meas tran mean AVG v(out) FROM=9m"
  ".tran 1u 10m uic"
}, "\n");

result = pwlsim_run (deck);
out = result.values(:, strcmp (result.names, "v(out)"));
printf ("%d rows, %d times of switching; overshoot to %.3f V\n", numel (result.time), numel (result.events), max (out));

for duty = [0.3 0.45 0.6]
  result = pwlsim_run (deck, "duty", duty);
  printf ("duty %.2f  mean %.4f V  textbook %.4f V\n", duty, result.measurements.mean, duty * 24);
  assert (result.measurements.mean, duty * 24, -1e-3);
end

try
  pwlsim_run (strrep (deck, "sw diode", "sw diodes"));
catch mistake
  disp (mistake.identifier);
end
