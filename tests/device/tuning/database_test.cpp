// What    The file of tunings: there and back, merging, foreign keys, and files that are none.
#include "device/tuning/database.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "kdray/error.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

const tuning::Key kKey = {"cpu, 2 units", "PoCL 3.1", "00ff", "slices", "0x00000102"};

tuning::Entry entry(const tuning::Key& key, int batch, std::int64_t when) {
  return {.key = key,
          .settings = {.batch = batch},
          .ratio = 0.9,
          .seconds = 12.5,
          .when = when,
          .scenes = {"a \"b\"\n"}};
}

tuning::Key with_features(const std::string& features) {
  tuning::Key key = kKey;
  key.features = features;
  return key;
}

TEST(Database, ThereAndBackIsTheSame) {
  const Folder folder;
  const std::filesystem::path file = folder.path() / "new" / "tune.json";
  tuning::Database database;
  database.put(entry(kKey, 1024, 5));
  database.put(entry(with_features(tuning::kAnyFeatures), 256, 6));
  database.write(file);
  const tuning::Database read = tuning::Database::read(file);
  ASSERT_EQ(read.entries().size(), 2u);
  EXPECT_EQ(read.text(), database.text());
  const tuning::Entry& e = read.entries().front();
  EXPECT_EQ(e.key, kKey);
  EXPECT_EQ(e.settings, Tuning{.batch = 1024});
  EXPECT_EQ(e.ratio, 0.9);
  EXPECT_EQ(e.scenes, std::vector<std::string>{"a \"b\"\n"});
}

TEST(Database, NoFileIsAnEmptyOne) {
  EXPECT_TRUE(tuning::Database::read("no/such/file").entries().empty());
}

TEST(Database, AForeignKeyFindsNothingAndAnyFeaturesServeTheRest) {
  tuning::Database database;
  database.put(entry(kKey, 1024, 5));
  for (std::string tuning::Key::*member : {&tuning::Key::device, &tuning::Key::driver, &tuning::Key::kernels,
                                           &tuning::Key::schedule, &tuning::Key::features}) {
    tuning::Key other = kKey;
    other.*member += "x";
    EXPECT_EQ(database.find(other), nullptr);
  }
  EXPECT_EQ(database.find(kKey)->settings.batch, 1024);
  database.put(entry(with_features(tuning::kAnyFeatures), 256, 5));
  EXPECT_EQ(database.find(kKey)->settings.batch, 1024) << "its own entry comes first";
  EXPECT_EQ(database.find(with_features("0x1"))->settings.batch, 256);
}

TEST(Database, MergingKeepsTheNewerOfTwoAndAllOthers) {
  tuning::Database a, b;
  a.put(entry(kKey, 1024, 5));
  a.put(entry(with_features("0x1"), 1024, 9));
  b.put(entry(kKey, 256, 6));
  b.put(entry(with_features("0x1"), 256, 8));
  b.put(entry(with_features("0x2"), 2048, 1));
  a.merge(b);
  ASSERT_EQ(a.entries().size(), 3u);
  EXPECT_EQ(a.find(kKey)->settings.batch, 256);
  EXPECT_EQ(a.find(with_features("0x1"))->settings.batch, 1024);
  EXPECT_EQ(a.find(with_features("0x2"))->settings.batch, 2048);
}

TEST(Database, WhatIsNoFileOfTuningsIsRefusedInOneLine) {
  tuning::Database database;
  database.put(entry(kKey, 1024, 5));
  const std::string good = database.text();
  const auto with = [&](const std::string& what, const std::string& by) {
    std::string text = good;
    return text.replace(text.find(what), what.size(), by);
  };
  const std::vector<std::string> bad = {
      "",
      "{}",
      "[]",
      "42",
      "\xff\xfe",
      "{\"kdray_tunings\":" + std::string(1000000, '[') + std::string(1000000, ']') + "}",
      good.substr(0, good.size() / 2),
      with("\"kdray_tunings\": 1", "\"kdray_tunings\": 2"),
      with("1024", "1000"),
      with("1024", "-1"),
      with("1024", "\"many\""),
      with("1024", "1e99"),
      with("1024", "4294968320"),
      with("\"batch\"", "\"colour\""),
      with("\"driver\"", "\"drover\"")};
  for (const std::string& text : bad) {
    try {
      tuning::Database::parse(text, "tune.json");
      ADD_FAILURE() << "taken: " << text.substr(0, 400);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      EXPECT_TRUE(std::string(error.what()).starts_with("tune.json: ")) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

TEST(Database, EveryCutOfAFileIsRefusedOrTheWhole) {
  tuning::Database database;
  database.put(entry(kKey, 1024, 5));
  const std::string good = database.text();
  for (std::size_t n = 0; n + 2 < good.size(); ++n)
    EXPECT_THROW(tuning::Database::parse(good.substr(0, n), "cut"), Error) << n;
}

TEST(Database, TheEnvironmentNamesTheFile) {
  ::setenv("XDG_DATA_HOME", "/data", 1);
  ::unsetenv("KDRAY_TUNE_FILE");
  EXPECT_EQ(tuning::default_file(), "/data/kdray/tune.json");
  ::setenv("KDRAY_TUNE_FILE", "own.json", 1);
  EXPECT_EQ(tuning::default_file(), "own.json");
  ::setenv("KDRAY_TUNE_FILE", "", 1);
  EXPECT_TRUE(tuning::default_file().empty());
  ::unsetenv("KDRAY_TUNE_FILE");
  ::unsetenv("XDG_DATA_HOME");
  ::setenv("HOME", "/home/someone", 1);
  EXPECT_EQ(tuning::default_file(), "/home/someone/.local/share/kdray/tune.json");
}

}  // namespace
}  // namespace kdray::test
