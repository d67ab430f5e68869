#include <boost/spirit.hpp>
