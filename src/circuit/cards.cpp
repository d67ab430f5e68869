#include "circuit/cards.hpp"

#include <algorithm>

#include "base/names.hpp"

namespace pwlsim::circuit {
namespace {

constexpr CardKind kinds[] = {
    {".subckt", CardRole::subcircuit, "begins a subcircuit"},
    {".ends", CardRole::end_of_subcircuit, "ends a subcircuit"},
    {".param", CardRole::parameter, "defines parameters"},
    {".params", CardRole::parameter, "defines parameters"},
    {".global_param", CardRole::parameter, "defines parameters"},
    {".func", CardRole::function, "defines a function"},
    {".model", CardRole::model, "defines a model"},
    {".global", CardRole::global, "names nodes that are one in all subcircuits"},
    {".ic", CardRole::condition, "gives voltages and currents at the start"},
    {".options", CardRole::options, "sets options"},
    {".option", CardRole::options, "sets options"},
    {".opt", CardRole::options, "sets options"},
    {".tran", CardRole::transient, "requests a transient analysis"},
    {".pss", CardRole::steady_state, "requests the periodic steady state"},
    {".pop", CardRole::steady_state, "requests the periodic steady state"},
    {".op", CardRole::operating_point, "requests the operating point"},
    {".save", CardRole::save, "names the signals of the output"},
    {".probe", CardRole::save, "names the signals of the output"},
    {".probe64", CardRole::save, "names the signals of the output"},
    {".print", CardRole::print, "names the signals of the output"},
    {".backanno", CardRole::ltspice, "LTspice writes it into its netlists"},
    {".title", CardRole::silent, "means nothing here"},
    {".protect", CardRole::silent, "means nothing here"},
    {".unprotect", CardRole::silent, "means nothing here"},
    {".prot", CardRole::silent, "means nothing here"},
    {".unprot", CardRole::silent, "means nothing here"},
    {".nodeset", CardRole::ignored, "hints for an iteration that is not needed here"},
    {".temp", CardRole::ignored, "temperatures have no effect"},
    {".plot", CardRole::ignored, "line-printer plots"},
    {".width", CardRole::ignored, "line-printer width"},
    {".ac", CardRole::small_signal, "requests small signals around the steady state"},
    {".sens", CardRole::sensitivity, "requests derivatives of measurements"},
    {".dc", CardRole::ignored, "DC sweep"},
    {".noise", CardRole::ignored, "noise analysis"},
    {".tf", CardRole::ignored, "small-signal transfer function"},
    {".meas", CardRole::measurement, "measures a signal"},
    {".measure", CardRole::measurement, "measures a signal"},
    {".four", CardRole::fourier, "Fourier analysis"},
    {".fourier", CardRole::fourier, "Fourier analysis"},
    {".pz", CardRole::ignored, "poles and zeros"},
    {".disto", CardRole::ignored, "small-signal distortion"},
    {".net", CardRole::ignored, "two-port parameters"},
    {".wave", CardRole::ignored, "sound files"},
    {".ferret", CardRole::ignored, "downloads"},
    {".savebias", CardRole::ignored, "files of operating points"},
    {".loadbias", CardRole::ignored, "files of operating points"},
    {".csparam", CardRole::ignored, "parameters of .control blocks"},
    {".mc", CardRole::ignored, "Monte Carlo runs"},
    {".wcase", CardRole::ignored, "worst-case runs"},
    {".distribution", CardRole::ignored, "Monte Carlo runs"},
    {".alias", CardRole::ignored, "names of a schematic"},
    {".endalias", CardRole::ignored, "names of a schematic"},
    {".aliases", CardRole::ignored, "names of a schematic"},
    {".endaliases", CardRole::ignored, "names of a schematic"},
    {".stmlib", CardRole::ignored, "libraries of stimuli"},
    {".watch", CardRole::ignored, "values shown during a run"},
    {".vector", CardRole::ignored, "files of logic states"},
    {".text", CardRole::ignored, "parameters of text"},
    {".autoconverge", CardRole::ignored, "hints for an iteration that is not needed here"},
    {".preprocess", CardRole::ignored, "Xyce's changes of the deck"},
    {".sampling", CardRole::ignored, "Monte Carlo runs"},
    {".embeddedsampling", CardRole::ignored, "Monte Carlo runs"},
    {".result", CardRole::ignored, "one number of each run of .step"},
    {".fft", CardRole::ignored, "Fourier analysis by samples"},
    {".hb", CardRole::ignored, "harmonic balance"},
    {".step", CardRole::sweep, "sweeps a parameter"},
    {".machine", CardRole::machine, "begins a state machine"},
    {".mach", CardRole::machine, "begins a state machine"},
    {".state", CardRole::machine_part, "names a state of a state machine"},
    {".rule", CardRole::machine_part, "leads a state machine from one state to another"},
    {".output", CardRole::machine_part, "is an output of a state machine"},
    {".endmachine", CardRole::end_of_machine, "ends a state machine"},
    {".endmach", CardRole::end_of_machine, "ends a state machine"},
    {".if", CardRole::section, "begins cards that count if a condition holds"},
    {".elseif", CardRole::section, "begins cards that count if another condition holds"},
    {".else", CardRole::section, "begins cards that count otherwise"},
    {".endif", CardRole::section, "ends cards that count if a condition holds"},
    {".lcs", CardRole::raw_system, "a raw linear complementarity system"},
};

constexpr RefusedElement refused[] = {
    {'N', "N (compiled model)"},
    {'O', "O (lossy line)"},
    {'P', "P (coupled line)"},
    {'T', "T (transmission line)"},
    {'U', "U (distributed RC line or digital block)"},
    {'Y', "Y (lossy line)"},
};

constexpr std::string_view foreign_types[] = {
    "CORE",        "URC",        "LTRA",       "TRN",      "NMF",       "PMF",     "PIGBT",         "NHFET",
    "PHFET",       "mult",       "divide",     "slew",     "climit",    "ilimit",  "sidiode",       "aswitch",
    "adc_bridge",  "dac_bridge", "core",       "lcouple",  "sine",      "square",  "triangle",      "oneshot",
    "cmeter",      "lmeter",     "d_and",      "d_nand",   "d_or",      "d_nor",   "d_xor",         "d_xnor",
    "d_buffer",    "d_inverter", "d_dff",      "d_jkff",   "d_tff",     "d_srff",  "d_dlatch",      "d_srlatch",
    "d_tristate",  "d_pullup",   "d_pulldown", "d_open_c", "d_source",  "d_fdiv",  "d_state",       "d_ram",
    "d_osc",       "d_pwm",      "d_genlut",   "d_lut",    "d_process", "pswitch", "potentiometer", "multi_input_pwl",
    "file_source",
};

}  // namespace

std::span<const CardKind> card_kinds() { return kinds; }

const CardKind* find_card(std::string_view full_name) {
  const std::string_view name = full_name.substr(0, full_name.find('/'));  // PSpice's .TRAN/OP, .PROBE/CSDF
  const auto* found = std::find_if(std::begin(kinds), std::end(kinds), [&](const CardKind& kind) { return same_name(kind.name, name); });
  return found == std::end(kinds) ? nullptr : found;
}

const RefusedElement* find_refused_element(char letter) {
  const auto matches = [&](const RefusedElement& element) { return lower_letter(element.letter) == lower_letter(letter); };
  const auto* found = std::find_if(std::begin(refused), std::end(refused), matches);
  return found == std::end(refused) ? nullptr : found;
}

bool is_foreign_model_type(std::string_view type) { return is_one_of(foreign_types, type); }

}  // namespace pwlsim::circuit
