// What    The drivers that are registered, as files tell, and the keys of their verdicts.
#include "probe/trial/drivers.h"

#include <gtest/gtest.h>

#include <chrono>
#include <set>

#include "support/folder.h"
#include "support/variable.h"

namespace kdray::trial {
namespace {

namespace fs = std::filesystem;

TEST(Drivers, AreTheIcdFilesOfTheFolder) {
  const test::Folder folder;
  const test::Variable vendors("OCL_ICD_VENDORS", folder.path().string());
  EXPECT_TRUE(registered_drivers().empty());
  folder.put("b.icd", "libb.so.1\nmore\n");
  folder.put("a.icd", "/opt/a/liba.so");
  folder.put("c.icd", "");
  folder.put("d.txt", "libd.so\n");
  folder.put("e.icd", std::string("\x7f"
                                  "ELF\x01",
                                  5));
  const std::vector<Driver> drivers = registered_drivers();
  ASSERT_EQ(drivers.size(), 4u);
  EXPECT_EQ(drivers[0].name(), "/opt/a/liba.so (a.icd)");
  EXPECT_EQ(drivers[1].name(), "libb.so.1 (b.icd)");
  EXPECT_EQ(drivers[1].where(), (folder / "b.icd").string());
  EXPECT_NE(drivers[2].unreadable.find("empty"), std::string::npos);
  EXPECT_NE(drivers[3].unreadable.find("no text"), std::string::npos);
}

TEST(Drivers, OclIcdVendorsMayNameAFileOrALibrary) {
  const test::Folder folder;
  folder.put("a.icd", "liba.so\n");
  folder.put("b.icd", "libb.so\n");
  const test::Variable file("OCL_ICD_VENDORS", (folder / "b.icd").string());
  ASSERT_EQ(registered_drivers().size(), 1u);
  EXPECT_EQ(registered_drivers()[0].library, "libb.so");
  const test::Variable library("OCL_ICD_VENDORS", "libc.so.2");
  ASSERT_EQ(registered_drivers().size(), 1u);
  EXPECT_TRUE(registered_drivers()[0].is_library);
  EXPECT_EQ(registered_drivers()[0].name(), "libc.so.2");
  EXPECT_EQ(registered_drivers()[0].where(), "OCL_ICD_VENDORS");
}

TEST(Drivers, AnythingThatChangesADriverChangesItsKey) {
  const test::Folder folder;
  const test::Variable none("RUSTICL_ENABLE");
  const test::Variable vendors("OCL_ICD_VENDORS", folder.path().string());
  folder.put("a.icd", (folder / "liba.so").string());
  std::set<std::string> keys;
  const auto is_new = [&] { return keys.insert(in_hex(key_of(registered_drivers().at(0)))).second; };
  EXPECT_TRUE(is_new());
  EXPECT_FALSE(is_new());
  folder.put("liba.so", "a library");
  EXPECT_TRUE(is_new()) << "it is there";
  folder.put("liba.so", "another library");
  EXPECT_TRUE(is_new()) << "its size";
  fs::last_write_time(folder / "liba.so", fs::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_TRUE(is_new()) << "its time";
  fs::last_write_time(folder / "a.icd", fs::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_TRUE(is_new()) << "the file's time";
  const test::Variable enabled("RUSTICL_ENABLE", "llvmpipe");
  EXPECT_TRUE(is_new()) << "the environment";
  const test::Variable cache("POCL_CACHE_DIR", "/somewhere"), chosen("CUDA_VISIBLE_DEVICES", "1");
  EXPECT_FALSE(is_new());
}

}  // namespace
}  // namespace kdray::trial
