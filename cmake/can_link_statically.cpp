#include <fmt/format.h>

int main(int argc, char**) { return fmt::format("{} {:.3e}", argc, 0.5).empty(); }
