#include "circuit/up.hpp"
