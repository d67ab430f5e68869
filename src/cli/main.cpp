#include "cli/program.hpp"

int main(int argument_count, char** arguments) { return pwlsim::cli::run_program(argument_count, arguments, PWLSIM_VERSION); }
