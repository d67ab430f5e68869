#include "cli/heap.hpp"
#include "cli/program.hpp"

int main(int argument_count, char** arguments) {
  pwlsim::cli::prepare_heap();
  return pwlsim::cli::run_program(argument_count, arguments, PWLSIM_VERSION);
}
