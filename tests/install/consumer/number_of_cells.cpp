// What a program of somebody else's looks like that reads a model file.
#include "format/io/trimmed_model_io.hpp"

#include <iostream>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const iga::TrimmedModel model = iga::io::read_model(argv[1]);
  std::cout << model.num_cells() << "\n";
}
