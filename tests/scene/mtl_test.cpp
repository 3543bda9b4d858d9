#include "scene/import/obj/mtl.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "scene/import/load.h"
#include "scene/model/check_scene.h"
#include "scene/scratch.h"

namespace kdray::scene {
namespace {

std::vector<MtlMaterial> read(const std::string& text) {
  std::vector<MtlMaterial> materials;
  std::vector<std::string> warnings;
  read_mtl(text, "a.mtl", materials, warnings);
  return materials;
}

Material whitted(const std::string& statements) {
  const auto materials = read("newmtl m\n" + statements);
  const Material m = whitted_from_mtl(materials.at(0));
  EXPECT_EQ(fault_of(m), nullptr) << statements;
  return m;
}

#define EXPECT_SAYS(message, part) EXPECT_NE((message).find(part), std::string::npos) << (message)

void expect_near(const vec3& a, const vec3& b) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-6) << i;
}

TEST(Mtl, KnowsWhatItLeavesOut) {
  const auto m = read(
      "newmtl a\nmap_d -t 1 1 1 a.png\nmap_bump -bm 0.5 b.png\nnorm n.png\nPr 0\nPm 0\nPm 0.0\nmap_Ns "
      "e.png\nmap_Ns "
      "e.png\n"
      "newmtl b\nmap_Kd a.png\nKd 1 1 1\nPm 0.5\n");
  EXPECT_EQ(m[0].left_out, (std::vector<std::string>{"map_d -t", "Pr", "map_Ns"}));
  EXPECT_EQ(m[0].map_d->file, "a.png");
  EXPECT_EQ(m[0].relief->file, "b.png");
  EXPECT_EQ(m[0].relief->strength, 0.5);
  EXPECT_EQ(m[0].normals->file, "n.png");
  EXPECT_EQ(m[1].left_out, (std::vector<std::string>{"Pm"}));
}

TEST(Mtl, ReadsItsStatements) {
  const auto m = read(
      "Kd 9 9 9\n# before the first\n\nnewmtl  a b \n\tKd .1 0.2 3e-1 # red\n Ks 0.5\nKe 1 2 3\nNs 40\n"
      "Ni 1.5\nd -halo 0.25\nTr 0.5\nTf 0.1 0.2 2\nillum 7\nmap_Kd -o 1 1 a b.png\nPr 0.5\nnewmtl c\n");
  ASSERT_EQ(m.size(), 2u);
  EXPECT_EQ(m[0].name, "a b");
  EXPECT_EQ(m[0].kd, vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m[0].ks, vec3(0.5f));
  EXPECT_EQ(m[0].ke, vec3(1, 2, 3));
  EXPECT_EQ(m[0].ns, 40);
  EXPECT_EQ(m[0].ni, 1.5f);
  EXPECT_EQ(m[0].dissolve, 0.25f);
  EXPECT_EQ(m[0].tr, 0.5f);
  EXPECT_EQ(m[0].tf, vec3(0.1f, 0.2f, 1));
  EXPECT_EQ(m[0].illum, 7);
  ASSERT_TRUE(m[0].map_kd.has_value());
  EXPECT_EQ(m[0].map_kd->file, "a b.png");
  EXPECT_EQ(m[0].map_kd->offset, (std::array<double, 2>{1, 1}));
  EXPECT_FALSE(m[1].illum.has_value());
}

TEST(Mtl, TakesTheDefaultForWhatIsNoNumber) {
  std::vector<MtlMaterial> m;
  std::vector<std::string> warnings;
  read_mtl("newmtl a\nKd 1 x 1\nKs 1 1\nNs inf\nd\nTr nan\nillum two\nTf 1 nan 1\nnewmtl b\nKd\nKe 0.5\n",
           "a.mtl", m, warnings);
  const MtlMaterial plain;
  EXPECT_EQ(m[0].kd, plain.kd);
  EXPECT_EQ(m[0].ks, plain.ks);
  EXPECT_EQ(m[0].ns, plain.ns);
  EXPECT_FALSE(m[0].dissolve || m[0].tr || m[0].illum || m[0].tf);
  EXPECT_EQ(m[1].ke, vec3(0.5f));
  ASSERT_EQ(warnings.size(), 7u);
  EXPECT_SAYS(warnings[0], "a.mtl:2: 2 values of 'Kd' are not finite numbers: its default holds (the first");
  EXPECT_SAYS(warnings[1], "a.mtl:3: 1 values of 'Ks'");
}

TEST(Mtl, ReadsKeywordsInAnyCapitalsAndTellsOfOthers) {
  std::vector<MtlMaterial> m;
  std::vector<std::string> warnings;
  read_mtl(
      "Kd 0 0 0\nNEWMTL a\nkd 1 0 0\nMAP_KD a.png\nMap_Bump 'b c.png'\nMAP_NS n.png\nTR 0.5\nka 1 1 1\n"
      "map_ao o.png\nnonsense\nnonsense\n",
      "a.mtl", m, warnings);
  ASSERT_EQ(m.size(), 1u);
  EXPECT_EQ(m[0].name, "a");
  EXPECT_EQ(m[0].kd, vec3(1, 0, 0));
  EXPECT_EQ(m[0].tr, 0.5f);
  ASSERT_TRUE(m[0].map_kd && m[0].relief);
  EXPECT_EQ(m[0].map_kd->file, "a.png");
  EXPECT_EQ(m[0].left_out, (std::vector<std::string>{"map_Ns"}));
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_SAYS(warnings[0], "a.mtl:1: 1 statements before the first 'newmtl' are left out");
  EXPECT_SAYS(warnings[1], "a.mtl:9: 3 lines that are no MTL statements are left out");
}

TEST(Mtl, LeavesOutOtherColourSystems) {
  std::vector<MtlMaterial> materials;
  std::vector<std::string> warnings;
  read_mtl("newmtl a\nKd spectral x.rfl\nKs xyz 1 1 1\n", "a.mtl", materials, warnings);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_SAYS(warnings[0], "a.mtl:2: 1 values 'Kd spectral' are left out");
  EXPECT_EQ(materials[0].ks, vec3(0));
}

TEST(WhittedFromMtl, FollowsTheIlluminationModels) {
  const std::string all = "Kd 0.5 0.4 0.3\nKs 0.2\nNs 50\nNi 1.5\n";
  for (const std::string illum : {"0", "1", "10"}) {
    const Material m = whitted(all + "illum " + illum);
    EXPECT_EQ(m.diffuse, vec3(0.5f, 0.4f, 0.3f));
    expect_near(m.ambient, vec3(0.05f, 0.04f, 0.03f));
    EXPECT_EQ(m.specular, vec3(0));
    EXPECT_EQ(m.reflect, vec3(0));
  }
  const Material plastic = whitted(all + "illum 2");
  EXPECT_EQ(plastic.specular, vec3(0.2f));
  EXPECT_EQ(plastic.shine, 50);
  EXPECT_EQ(plastic.reflect, vec3(0));
  EXPECT_EQ(whitted(all), plastic);  // the default
  for (const std::string illum : {"3", "5", "8"})
    EXPECT_EQ(whitted(all + "illum " + illum).reflect, vec3(0.2f));
  for (const std::string illum : {"4", "6", "7", "9"}) {
    const Material glass = whitted(all + "d 0.25\nTf 1 0.5 0\nillum " + illum);
    expect_near(glass.transmit, vec3(0.75f, 0.375f, 0));
    expect_near(glass.diffuse, vec3(0.125f, 0.1f, 0.075f));
    EXPECT_EQ(glass.reflect, vec3(0.2f));
    EXPECT_EQ(glass.index, 1.5f);
  }
}

TEST(WhittedFromMtl, TakesADissolveForAVeil) {
  const Material m = whitted("Kd 1 1 1\nNi 1.5\nd 0.25\nillum 2");
  EXPECT_EQ(m.transmit, vec3(0.75f));
  EXPECT_EQ(m.diffuse, vec3(0.25f));
  EXPECT_EQ(m.index, 1);
  EXPECT_EQ(whitted("Kd 1 1 1\nTr 0.75\nillum 2").transmit, vec3(0.75f));
  EXPECT_EQ(whitted("Kd 1 1 1\nTr 0.75\nd 1\nillum 2").transmit, vec3(0));
}

TEST(WhittedFromMtl, MakesSenseOfCommonNonsense) {
  EXPECT_EQ(whitted("Kd 0 0 0\nmap_Kd a.png").diffuse, vec3(0.6f));
  EXPECT_EQ(whitted("Kd 0.1 0 0\nmap_Kd a.png").diffuse, vec3(0.1f, 0, 0));
  EXPECT_EQ(whitted("Ks 0.9\nNs 0\nillum 2").specular, vec3(0));
  EXPECT_EQ(whitted("Kd -1 0.5 0.5").diffuse, vec3(0, 0.5f, 0.5f));
  EXPECT_EQ(whitted("Ni 0\nTf 1 1 1\nillum 6").index, 1);
  // Glass that says it reflects and lets through everything: shared, as Fresnel's law does where the model
  // has it.
  const Material half = whitted("Ks 1 1 1\nTf 1 1 1\nNi 1.5\nillum 4");
  expect_near(half.reflect, vec3(0.5f));
  expect_near(half.transmit, vec3(0.5f));
  const Material fresnel = whitted("Ks 1 1 1\nTf 1 1 1\nNi 1.5\nillum 7");
  EXPECT_NEAR(fresnel.reflect.x, 0.04f + 0.96f / 21, 1e-6);
  EXPECT_NEAR(fresnel.reflect.x + fresnel.transmit.x, 1, 1e-6);
}

TEST(WhittedFromMtl, NeverSendsOnMoreLightThanItGets) {
  const unsigned seed = 20240607;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> any(0, 2);
  for (int i = 0; i < 2000; ++i) {
    MtlMaterial mtl;
    mtl.ks = {any(random), any(random), any(random)};
    mtl.tf = glm::min(vec3(any(random), any(random), any(random)), vec3(1));
    if (i % 3 == 0) mtl.dissolve = any(random) / 2;
    mtl.ni = any(random);
    mtl.illum = static_cast<int>(random() % 11);
    const Material m = whitted_from_mtl(mtl);
    EXPECT_EQ(fault_of(m), nullptr);
    for (int c = 0; c < 3; ++c) EXPECT_LE(m.reflect[c] + m.transmit[c], 1.00001f) << "illum " << *mtl.illum;
  }
}

TEST(WhittedFromMtl, TakesWhatMayaWritesOfOpaqueSurfacesForOpaque) {
  EXPECT_EQ(whitted("Kd 0.5 0.5 0.5\nTf 1 1 1\nNi 1\nillum 4").transmit, vec3(0));
  EXPECT_EQ(whitted("Kd 0.5 0.5 0.5\nTf 1 1 1\nNi 1\nillum 4").diffuse, vec3(0.5f));
  EXPECT_EQ(whitted("Tf 1 1 1\nNi 1.5\nillum 4").transmit, vec3(1));
  EXPECT_EQ(whitted("Tf 0.5 0.5 0.5\nNi 1\nillum 4").transmit, vec3(0.5f));
  EXPECT_EQ(whitted("Tf 1 1 1\nNi 1\nd 0.25\nillum 4").transmit, vec3(0.75f));
}

// `d 0` and `Tr 1` throughout are how exporters have written opaque; a glass body is glass.
TEST(MaterialsOfObj, AreOpaqueWhereNothingWouldBeSeen) {
  const test::ScratchFolder folder;
  const auto transmit_of = [&](const std::string& mtl) {
    folder.write("a.mtl", mtl);
    const Scene s = read_obj(
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl m\nf 1 2 3\nusemtl n\nf 1 2 3\n", folder / "a.obj");
    EXPECT_EQ(s.warnings.size(), s.materials[0].transmit == vec3(0) ? 1u : 0u);
    return std::array{s.materials[0].transmit.x, s.materials[1].transmit.x};
  };
  EXPECT_EQ(transmit_of("newmtl m\nTr 1\nnewmtl n\nd 0\n"), (std::array{0.0f, 0.0f}));
  EXPECT_EQ(transmit_of("newmtl m\nTr 1\nnewmtl n\nd 0.5\n"), (std::array{1.0f, 0.5f}));
  EXPECT_EQ(transmit_of("newmtl m\nTr 1\nKe 1 0 0\nnewmtl n\nd 0\n"), (std::array{1.0f, 1.0f}));
  EXPECT_EQ(transmit_of("newmtl m\nTr 1\nillum 3\nKs 0.5 0.5 0.5\nnewmtl n\nd 0\n")[1], 1);
  EXPECT_EQ(transmit_of("newmtl m\nTr 1\nNi 1.5\nillum 6\nnewmtl n\nd 0\n"), (std::array{1.0f, 1.0f}));
}

}  // namespace
}  // namespace kdray::scene
