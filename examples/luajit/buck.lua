-- A buck converter from Lua, by the foreign interface of LuaJIT (Debian: luajit): no glue code, the C header is enough.
--
--     luajit buck.lua [libpwlsim.so] [pwlsim.h]
--
-- The output voltage of the steady state beside duty times input (Erickson and Maksimovic, chapter 2).
local ffi = require("ffi")

-- The declarations of pwlsim.h, without what is for the preprocessor.
local header = assert(io.open(arg[2] or "/usr/local/include/pwlsim.h")):read("*a")
header = header:gsub("/%*.-%*/", ""):gsub('extern "C" {', "")
local declarations = {}
for line in header:gmatch("[^\n]+") do
  if not line:match("^#") and line ~= "}" then declarations[#declarations + 1] = line:gsub("PWLSIM_API ", "") end
end
ffi.cdef(table.concat(declarations, "\n"))
local pwlsim = ffi.load(arg[1] or "pwlsim")

local function check(status)
  if status ~= pwlsim.PWLSIM_OK then error(ffi.string(pwlsim.pwlsim_last_error())) end
end

local place = ffi.new("pwlsim_circuit*[1]")
check(pwlsim.pwlsim_parse_text([[
buck
V1 in 0 24
VG gate 0 PULSE(0 1 0 0 0 4.5u 10u)
S1 in sw gate 0 ideal
.model ideal SW(Vt=0.5)
D1 0 sw diode
.model diode D
L1 sw out 47u
C1 out 0 100u
R1 out 0 2.5
.save v(out) i(L1)
.meas tran mean AVG v(out) FROM=9m
.tran 10u 10m uic
]], place))
local circuit = ffi.gc(place[0], pwlsim.pwlsim_circuit_free)

local made = ffi.new("pwlsim_result*[1]")
check(pwlsim.pwlsim_run(circuit, nil, made))
local result = ffi.gc(made[0], pwlsim.pwlsim_result_free)

local mean = ffi.new("double[1]")
check(pwlsim.pwlsim_measure(result, "mean", mean))
local rows, output = tonumber(pwlsim.pwlsim_rows(result)), pwlsim.pwlsim_signal(result, "v(out)")
local highest = 0
for k = 0, rows - 1 do highest = math.max(highest, output[k]) end
print(("%d rows, %d events; overshoot to %.3f V; mean %.6f V, textbook %.6f V"):format(
  rows, tonumber(pwlsim.pwlsim_events(result)), highest, mean[0], 0.45 * 24))
assert(math.abs(mean[0] - 0.45 * 24) < 1e-3 * 0.45 * 24)

assert(pwlsim.pwlsim_signal(result, "v(nowhere)") == nil)
print(ffi.string(pwlsim.pwlsim_last_error_id()))
