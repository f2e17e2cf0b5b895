#include "solver/explicit/laws/material_settings.hpp"

#include "format/io/settings_reader.hpp"
#include "format/model/errors.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace iga::solve {
namespace {

class MaterialFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("iga_material_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

  MaterialSettings read(const std::string& keys) const {
    write("run.toml", "[material]\n" + keys);
    auto root = io::SettingsTable::read(folder_ / "run.toml");
    auto table = root.table("material");
    auto material = read_material(table);
    root.refuse_unknown_keys();
    return material;
  }
  std::string refusal(const std::string& keys) const {
    try {
      read(keys);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
};

const std::string elastic = "rho = 2\nE = 10\nnu = 0.3\n";

TEST_F(MaterialFile, EveryLawIsRead) {
  EXPECT_TRUE(std::holds_alternative<NeoHookean>(read(elastic).law));
  EXPECT_TRUE(std::holds_alternative<LinearElastic>(read("law = \"linear-elastic\"\n" + elastic).law));
  EXPECT_TRUE(std::holds_alternative<StVenantKirchhoff>(read("law = \"st-venant-kirchhoff\"\n" + elastic).law));
  EXPECT_TRUE(std::holds_alternative<J2Plasticity>(
      read("law = \"j2\"\nyield_stress = 1\nhardening_modulus = 2\nrate_law = \"cowper-symonds\"\nrate_reference = "
           "40\nrate_exponent = 5\n" +
           elastic)
          .law));
  EXPECT_TRUE(std::holds_alternative<CrushableFoam>(
      read("law = \"crushable-foam\"\nyield_curve = [[0, 1], [0.5, 2]]\ntension_limit = 0.5\ndamping = 0.1\n" + elastic)
          .law));
  EXPECT_TRUE(std::holds_alternative<EllipticFoam>(
      read("law = \"elliptic-foam\"\nplateau = 1\nhardening_log = 2\nhardening_power = 4\ndensification_strain = "
           "1.8\nplastic_nu = 0.1\n" +
           elastic)
          .law));
  EXPECT_TRUE(std::holds_alternative<BulkViscosity<NeoHookean>>(read("bulk_viscosity = [1.5, 0.06]\n" + elastic).law));
  EXPECT_TRUE(std::holds_alternative<NeoHookean>(read("bulk_viscosity = [0, 0]\n" + elastic).law));
}

TEST_F(MaterialFile, SmallStrainsOfEveryLawAreThoseOfTheElasticConstants) {
  const ElasticMaterial expected = isotropic(10, 0.3, 2);
  for (const std::string keys :
       {"", "law = \"st-venant-kirchhoff\"\n", "law = \"j2\"\nyield_stress = 1\n", "bulk_viscosity = [1, 0]\n",
        "law = \"crushable-foam\"\nyield_curve = [[0, 1]]\n", "law = \"elliptic-foam\"\nyield_curve = [[0, 1]]\n"}) {
    const ElasticMaterial found = small_strain(read(keys + elastic).law);
    EXPECT_LE((found.C - expected.C).norm(), 1e-13) << keys;
    EXPECT_EQ(found.density, 2);
    std::visit([&](const auto& law) { EXPECT_NEAR(law.reference_wave_speed(), expected.fastest_wave(), 1e-12); },
               read(keys + elastic).law);
  }
}

TEST_F(MaterialFile, InvertedPointsFollowTheirSettings) {
  EXPECT_EQ(read(elastic).inversion.action, InvertedPoints::Clamp);
  EXPECT_EQ(read(elastic).inversion.smallest_J, 0.05);
  EXPECT_EQ(read("law = \"crushable-foam\"\nyield_curve = [[0, 1]]\n" + elastic).inversion.smallest_J, 0.02);
  const auto material = read("inversion = \"erode\"\nmin_volume_ratio = 0.1\n" + elastic);
  EXPECT_EQ(material.inversion.action, InvertedPoints::Erode);
  EXPECT_EQ(std::get<NeoHookean>(material.law).inversion.action, InvertedPoints::Erode);
  EXPECT_EQ(std::get<NeoHookean>(material.law).inversion.smallest_J, 0.1);
  EXPECT_EQ(read("inversion = \"stop\"\n" + elastic).inversion.action, InvertedPoints::Stop);
}

TEST_F(MaterialFile, AnElasticityMatrixIsRead) {
  const std::string isotropic_matrix = "C = [4, 2, 2, 0, 0, 0, 4, 2, 0, 0, 0, 4, 0, 0, 0, 1, 0, 0, 1, 0, 1]\n";
  const auto material = read("law = \"linear-elastic\"\nrho = 1\n" + isotropic_matrix);
  EXPECT_NEAR(std::get<LinearElastic>(material.law).reference_wave_speed(), 2, 1e-12);
  EXPECT_NE(refusal("rho = 1\n" + isotropic_matrix).find("does not take it"), std::string::npos);
  EXPECT_NE(refusal("law = \"linear-elastic\"\n" + elastic + isotropic_matrix).find("not both"), std::string::npos);
}

TEST_F(MaterialFile, CurvesComeFromCsvFiles) {
  write("foam.csv", "strain; stress\n# EPP\n0; 0.3\n0.5, 0.4\n\n0.9\t2\n");
  const auto material = read("law = \"crushable-foam\"\nyield_curve = \"foam.csv\"\nrho = 6e-11\nE = 20\nnu = 0\n");
  EXPECT_TRUE(material.warnings.empty());
  const Curve curve = Curve::read_csv(folder_ / "foam.csv");
  EXPECT_EQ(curve.size(), 3U);
  EXPECT_NEAR(curve.value(0.25), 0.35, 1e-15);
  EXPECT_NEAR(curve.value(1), 2.4, 1e-14); // last slope 4
  EXPECT_EQ(curve.value(-1), 0.3);
  write("foam.csv", "0, 0.3\n0.5 abc\n");
  EXPECT_NE(refusal("law = \"crushable-foam\"\nyield_curve = \"foam.csv\"\n" + elastic).find("foam.csv:2"),
            std::string::npos);
  EXPECT_NE(refusal("law = \"crushable-foam\"\nyield_curve = \"no.csv\"\n" + elastic).find("no.csv"),
            std::string::npos);
}

TEST_F(MaterialFile, ImpactFoamIsWarnedOf) {
  const auto material = read("law = \"crushable-foam\"\nrho = 6e-8\nE = 0.05\nnu = 0\ntension_limit = 3e-4\n"
                             "yield_curve = [[0, 3.0e-4], [0.4, 3.5e-4], [0.6, 6e-4], [0.7, 1.2e-3], [0.8, 4e-3], "
                             "[0.9, 0.02], [0.95, 0.05]]\n");
  ASSERT_EQ(material.warnings.size(), 1U);
  EXPECT_NE(material.warnings[0].find("run.toml:7"), std::string::npos) << material.warnings[0];
  EXPECT_NEAR(small_strain(material.law).C(0, 0), 0.05, 1e-15);
}

TEST_F(MaterialFile, BadInputIsRefusedWithItsLine) {
  const auto expect = [&](const std::string& keys, const std::string& line, const std::string& words) {
    const std::string message = refusal(keys);
    EXPECT_NE(message.find("run.toml:" + line), std::string::npos) << message;
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  expect(elastic + "yeild_curve = 1\n", "5", "yield_curve");
  expect(elastic + "law = \"neohookean\"\n", "5", "did you mean neo-hookean");
  expect(elastic + "damping = 0.1\n", "5", "does not take it");
  expect("E = 10\nnu = 0.3\n", "1", "rho");
  expect("rho = -1\nE = 10\nnu = 0.3\n", "1", "rho");
  expect("law = \"j2\"\n" + elastic, "1", "yield stress");
  expect(elastic + "law = \"j2\"\nyield_stress = 1\nrate_exponent = 3\n", "7", "rate_law");
  expect(elastic + "law = \"crushable-foam\"\n", "1", "volumetric strain");
  const std::string foam = elastic + "law = \"crushable-foam\"\n";
  expect(foam + "yield_curve = [[0, 0], [1, 1]]\n", "5", "Y(0) = 0");
  expect(foam + "yield_curve = [[0, 1], [0, 2]]\n", "6", "ascending");
  expect(foam + "yield_curve = [[0, 1, 2]]\n", "6", "2 finite numbers");
  expect(foam + "yield_curve = 3\n", "6", "list of lists");
  expect(foam + "yield_curve = [[0, 1]]\nmodulus = \"e\"\n", "7", "lcid_final_slope");
  expect(elastic + "inversion = \"erase\"\n", "5", "erode");
  expect(elastic + "min_volume_ratio = 0\n", "5", "volume ratio");
  expect(elastic + "bulk_viscosity = [-1, 0]\n", "5", "Q1");
}

} // namespace
} // namespace iga::solve
