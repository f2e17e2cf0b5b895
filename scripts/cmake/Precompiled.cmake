# Headers that nearly every file of a library reads, compiled once: parsing Eigen, fmt and TBB takes longer than most of our
# own files. Sources still include what they use, so each compiles without this as well (-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON).

set(iga_standard_headers <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory> <numeric>
                         <optional> <span> <string> <utility> <variant> <vector>)
set(iga_common_headers ${iga_standard_headers} <fmt/format.h> <fmt/ranges.h>)
set(iga_numerical_headers ${iga_common_headers} <Eigen/Core> <Eigen/Cholesky> <Eigen/Geometry> <tbb/blocked_range.h>
                          <tbb/enumerable_thread_specific.h> <tbb/parallel_for.h>)
