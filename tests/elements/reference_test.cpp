#include <cstdlib>
#include <fstream>
#include <sstream>

#include <catch2/catch.hpp>

#include "elements/reference.hpp"

TEST_CASE("the element tables of the manual are those of the catalogue", "[golden][reference]") {
  const std::string path = PWLSIM_SOURCE_DIR "/docs/reference/elements.md";
  if (std::getenv("PWLSIM_WRITE_REFERENCE") != nullptr) std::ofstream(path, std::ios::binary) << pwlsim::elements::reference_tables();
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  CHECK(text.str() == pwlsim::elements::reference_tables());
}
