// Real parts and flawed ones: what the preparation must make of each file of the shared folder.
#include "format/model/errors.hpp"
#include "preprocessor/surface/prepare_surface.hpp"
#include "preprocessor/surface/surface_topology.hpp"

#include <filesystem>
#include <gtest/gtest.h>

namespace iga::prep {
namespace {

std::filesystem::path stl_folder() {
  return std::filesystem::path(IGA_SHARED_DIR) / "stl";
}

double volume_of(const std::filesystem::path& file, const SurfaceOptions& options = {}) {
  const PreparedSurface out = prepare_surface(read_mesh(file), options);
  EXPECT_TRUE(is_closed_chain(make_edge_table(out.mesh.triangles))) << file;
  return volume_moments(out.mesh).volume;
}

std::string refusal(const std::filesystem::path& file, const SurfaceOptions& options = {}) {
  try {
    prepare_surface(read_mesh(file), options);
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(SharedSurfaces, ValidPartsKeepTheirShape) {
  if (!std::filesystem::exists(stl_folder())) GTEST_SKIP() << "no folder with shared parts: " << stl_folder();
  for (const auto& entry : std::filesystem::directory_iterator(stl_folder() / "valid")) {
    SCOPED_TRACE(entry.path().filename().string());
    const ReadMesh input = read_mesh(entry.path());
    const double as_read = volume_moments(input.mesh).volume;
    const PreparedSurface out = prepare_surface(input, {});
    EXPECT_TRUE(is_closed_chain(make_edge_table(out.mesh.triangles)));
    EXPECT_FALSE(out.shape_changed);
    EXPECT_TRUE(out.warnings.empty()) << out.warnings.front();
    EXPECT_EQ(out.mesh.triangles.size(), input.mesh.triangles.size());
    EXPECT_NEAR(volume_moments(out.mesh).volume / as_read, 1, 1e-6);
  }
}

/// A flawed file: the option that mends it, the volume to reach.
struct Flawed {
  const char* file;
  bool needs_repair;
  const char* undamaged; ///< file whose volume counts; null: `volume`
  double volume;
  double tolerance = 1e-3;
};

class FlawedSurface : public ::testing::TestWithParam<Flawed> {};

TEST_P(FlawedSurface, ComesOutRight) {
  if (!std::filesystem::exists(stl_folder())) GTEST_SKIP() << "no folder with shared parts: " << stl_folder();
  const Flawed& c = GetParam();
  const auto file = stl_folder() / "flawed" / c.file;
  SurfaceOptions options;
  if (c.needs_repair) {
    const std::string text = refusal(file);
    EXPECT_NE(text.find("--repair"), std::string::npos) << text;
    EXPECT_NE(text.find(c.file), std::string::npos) << text;
    options.repair = true;
  }
  const double wanted = c.undamaged ? volume_of(stl_folder() / "valid" / c.undamaged) : c.volume;
  EXPECT_NEAR(volume_of(file, options) / wanted, 1, c.tolerance);
}

INSTANTIATE_TEST_SUITE_P(
    SharedSurfaces, FlawedSurface,
    ::testing::Values(Flawed{"elephant_allflipped.stl", false, "elephant.stl", 0, 1e-14},
                      Flawed{"elephant_flipped_0.01.stl", false, "elephant.stl", 0, 1e-12},
                      Flawed{"elephant_duplicated_1pc.stl", false, "elephant.stl", 0, 1e-12},
                      Flawed{"elephant_removed_0.001.stl", true, "elephant.stl", 0},
                      Flawed{"elephant_removed_0.01.stl", true, "elephant.stl", 0},
                      Flawed{"elephant_jitter_1e-06.stl", true, "elephant.stl", 0},
                      Flawed{"elephant_jitter_0.001.stl", true, "elephant.stl", 0},
                      Flawed{"cube_one_face_flipped.stl", false, nullptr, 1e6, 1e-12},
                      Flawed{"cube_one_face_missing.stl", true, nullptr, 1e6, 1e-12},
                      Flawed{"cube_one_tri_missing.stl", true, nullptr, 1e6, 1e-12},
                      // Boxes 60³ that share 20³.
                      Flawed{"cubes_overlap.stl", true, nullptr, 424000, 1e-12},
                      Flawed{"shared.STL", false, nullptr, 2, 1e-6},
                      // Closed chains as they are: the volumes by the divergence theorem over all facets.
                      Flawed{"display_faceplate_nonmanifold.stl", false, nullptr, 8441.9062, 1e-6},
                      Flawed{"z_motor_mount_nonmanifold.stl", false, nullptr, 9280.8613, 1e-6}),
    [](const auto& c) {
      std::string name = c.param.file;
      for (char& letter : name)
        if (!std::isalnum(static_cast<unsigned char>(letter))) letter = '_';
      return name;
    });

TEST(SharedSurfaces, UnitesTheInterpenetratingBodies) {
  if (!std::filesystem::exists(stl_folder())) GTEST_SKIP() << "no folder with shared parts: " << stl_folder();
  SurfaceOptions options;
  options.repair = true;
  const auto file = stl_folder() / "flawed" / "box.STL";
  EXPECT_NE(refusal(file).find("bodies overlap"), std::string::npos);
  const double counted_twice = volume_moments(read_mesh(file).mesh).volume;
  const double united = volume_of(file, options);
  EXPECT_LT(united, counted_twice);
  EXPECT_GT(united, 0.99 * counted_twice);
}

TEST(SharedSurfaces, RefusesWhatHoldsNoSolid) {
  if (!std::filesystem::exists(stl_folder())) GTEST_SKIP() << "no folder with shared parts: " << stl_folder();
  SurfaceOptions options;
  options.repair = true;
  for (const char* file : {"empty.stl", "stl_empty_ascii.stl", "stl_empty_bin.stl"})
    EXPECT_NE(refusal(stl_folder() / "flawed" / file, options).find("without any facet"), std::string::npos) << file;
  EXPECT_NE(refusal(stl_folder() / "flawed" / "soup.stl", options).find("--wrap"), std::string::npos);
  EXPECT_NE(refusal(stl_folder() / "flawed" / "teapot.stl").find("--repair"), std::string::npos);
}

} // namespace
} // namespace iga::prep
