// Settings files of igaprep, up to the text that names every setting.
#include "preprocessor/program/settings.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const iga::fuzz::ScratchFolder folder;
  const auto file = folder.write("prep.toml", iga::fuzz::bytes_of(data, size));
  iga::fuzz::read_or_refuse(
      [&] { iga::prep::canonical_text(iga::prep::validate(iga::prep::read_settings_file(file))); });
  return 0;
}
