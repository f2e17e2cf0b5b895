// Which body of a system a support, a load, a probe or a tie means.
#pragma once

#include "solver/mechanics/body_system.hpp"

#include <functional>

namespace iga::solve {

/// @param what  opens the message: "support 'base'"
/// @throws InputError naming the nearest
std::size_t body_by_name(const BodySystem& system, const std::string& name, const std::string& what);

/// The named body, or without a name the only one where `look` finds what it looks for.
/// @param look  throws InputError where the body of that number has no such surface or place
/// @throws InputError where several bodies have it, naming them, or none has, with each body's own message
std::size_t chosen_body(const BodySystem& system, const std::string& name, const std::string& what,
                        const std::function<void(std::size_t)>& look);

} // namespace iga::solve
