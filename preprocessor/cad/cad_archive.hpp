// What igaprep and its CAD reader, a program of its own, hand to each other: request and answer as bytes.
#pragma once

#include "preprocessor/cad/cad_model.hpp"

#include <string>
#include <string_view>

namespace iga::prep {

struct CadRequest {
  std::string version; ///< of igaprep: both programs must be of one
  std::string file;
  CadOptions options;
};

/// The model, or what went wrong.
struct CadAnswer {
  std::string version; ///< of the reader
  std::string error;   ///< text of the InputError; empty where there is a model
  CadModel model;
};

std::string to_bytes(CadRequest request);
std::string to_bytes(CadAnswer answer);
/// Of either; what follows may be laid out otherwise in another version.
std::string version_of(std::string_view bytes);
/// @throws std::runtime_error where the bytes end early
CadRequest request_of(std::string_view bytes);
CadAnswer answer_of(std::string_view bytes);

} // namespace iga::prep
