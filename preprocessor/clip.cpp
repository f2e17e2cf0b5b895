#include "preprocessor/clip.hpp"
