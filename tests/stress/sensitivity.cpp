#include "stress.hpp"
namespace stress { std::vector<Check> sensitivity(const Options&){return {};} }
