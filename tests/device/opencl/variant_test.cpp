// What    Programs that take another's place: which may, which is chosen, and that nothing else ever is. The
//         kernel's answer is the mask that it was built with.
#include "device/opencl/variant.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <thread>
#include <vector>

#include "device/opencl/context.h"
#include "device/opencl/program_cache.h"
#include "support/device.h"
#include "support/folder.h"
#include "support/variable.h"

namespace kdray::device {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kRule = 0x1, kRules = 0xffff;
constexpr std::uint64_t kA = 0x10000, kB = 0x20000, kC = 0x40000, kD = 0x80000, kAll = 0xf0000;

Variant wanted(std::uint64_t mask) {
  return {.options = "-cl-std=CL1.2 -DSTACK=1", .mask = mask, .spare = kAll};
}

TEST(Variant, AProgramCoversWhatItHasAllBitsOfAndNoneThatAreNotSpare) {
  EXPECT_TRUE(covers(kA, wanted(kA)));
  EXPECT_TRUE(covers(kA | kB, wanted(kA)));
  EXPECT_TRUE(covers(kAll | kRule, wanted(kA | kRule)));
  EXPECT_FALSE(covers(kB, wanted(kA)));
  EXPECT_FALSE(covers(0, wanted(kA)));
  EXPECT_FALSE(covers(kAll | kRule, wanted(kA))) << "a rule that is off";
  EXPECT_FALSE(covers(kAll, wanted(kA | kRule))) << "a rule that is on";
  EXPECT_FALSE(covers(kAll | 0x100000, wanted(kA))) << "a bit that nobody knows";
}

// Against the definition, bit by bit.
TEST(Variant, CoveringIsASubsetRelationOnSpareBitsAndEqualityElsewhere) {
  for (std::uint64_t mask = 0; mask < 64; ++mask)
    for (std::uint64_t want = 0; want < 64; ++want)
      for (std::uint64_t spare = 0; spare < 64; spare += 7) {
        bool right = true;
        for (int bit = 0; bit < 6; ++bit) {
          const bool has = mask >> bit & 1, needs = want >> bit & 1, may = spare >> bit & 1;
          right &= has == needs || (has && may);
        }
        EXPECT_EQ(covers(mask, {.options = "", .mask = want, .spare = spare}), right)
            << mask << " " << want << " " << spare;
      }
}

TEST(Variant, TheOneWithTheFewestOtherBitsComesFirst) {
  const std::vector<std::uint64_t> expected = {kA | kB, kA | kB | kC, kAll};
  EXPECT_EQ(covering({kAll, kC, kA | kB | kC, kA | kB, kB | kC, kAll | kRule}, wanted(kA | kB)), expected);
}

class VariantTest : public test::EachDevice {
 protected:
  VariantTest() { put_kernel(0); }

  // `salt` makes another source of it.
  void put_kernel(int salt) {
    fs::create_directories(root_ / "kernels");
    root_.put("kernels/mask.cl",
              "__kernel void tell(__global ulong* x) { x[0] = KDRAY_FEATURES; x[1] = STACK; } // " +
                  std::to_string(salt) + "\n");
  }

  struct Told {
    std::uint64_t mask, stack;
    bool compiled;
  };

  // As a process of its own would: builds, uses and keeps it.
  Told build(const Variant& variant, bool exact = false) {
    const Builds builds{
        .cache = std::make_shared<ProgramCache>(folder_), .watch = {}, .remember = false, .exact = exact};
    const OpenDevice& opened = context_.opened();
    const BuiltVariant built = build_variant(opened.context, opened.devices, "mask.cl", variant, builds);
    const Told told = run(built);
    EXPECT_EQ(told.mask, built.mask);
    builds.cache->keep();
    return told;
  }
  Told build(std::uint64_t mask) { return build(wanted(mask)); }

  Told run(const BuiltVariant& built) {
    cl::Kernel kernel(built.program, "tell");
    const cl::CommandQueue& queue = context_.opened().queues.front();
    cl_ulong x[2] = {};
    const cl::Buffer buffer(context_.opened().context, CL_MEM_READ_WRITE, sizeof x);
    kernel.setArg(0, buffer);
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
    queue.enqueueReadBuffer(buffer, CL_TRUE, 0, sizeof x, x);
    return {x[0], x[1], built.compiled};
  }

  void expect(const Told& told, std::uint64_t mask, bool compiled) {
    EXPECT_EQ(told.mask, mask);
    EXPECT_EQ(told.compiled, compiled);
  }

  std::vector<fs::path> entries() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder_)) files.push_back(entry.path());
    return files;
  }

  fs::path entry_of(std::uint64_t mask) const {
    const std::string ending = in_hex({0, mask}).substr(16) + ".program";
    for (const fs::path& file : entries())
      if (file.filename().string().ends_with(ending)) return file;
    ADD_FAILURE() << "no entry of mask " << mask;
    return {};
  }

  const Context context_{GetParam(), 1};
  const test::Folder root_;
  const fs::path folder_ = root_ / "programs";
  const test::Variable variable_{"KDRAY_KERNEL_DIR", (root_ / "kernels").string()};
};

TEST_P(VariantTest, OneThatCoversIsFoundAndNothingIsCompiled) {
  expect(build(kA | kB), kA | kB, true);
  expect(build(kA), kA | kB, false);
  expect(build(kB), kA | kB, false);
  expect(build(0), kA | kB, false);
  EXPECT_EQ(entries().size(), 1u);
}

TEST_P(VariantTest, TheExactOneIsPreferredThenTheClosest) {
  build(wanted(kAll), true);
  build(wanted(kA | kB), true);
  build(wanted(kA), true);
  expect(build(kA), kA, false);
  expect(build(kB), kA | kB, false);
  expect(build(kA | kC), kAll, false);
}

TEST_P(VariantTest, OneThatLacksABitIsNone) {
  expect(build(kA), kA, true);
  expect(build(kB), kB, true);
}

TEST_P(VariantTest, RulesAreNeverCrossed) {
  build(wanted(kAll | kRule), true);
  build(wanted(kA | kRules), true);
  expect(build(wanted(kA)), kA, true);
  expect(build(wanted(kA | kRule)), kAll | kRule, false);
  expect(build(wanted(kRule << 1)), kRule << 1, true);
}

TEST_P(VariantTest, OtherSourceOptionsAndEnvironmentAreOtherFamilies) {
  build(wanted(kAll), true);
  Variant other = wanted(kA);
  other.options += " -DMORE";
  expect(build(other), kA, true);
  put_kernel(1);
  expect(build(kA), kA, true);
  const test::Variable variable("POCL_WORK_GROUP_METHOD", "loops");
  expect(build(kA), kA, true);
}

TEST_P(VariantTest, OptionsThatServeInsteadDoWhereTheOwnDoNot) {
  Variant small = wanted(kA), large = wanted(kA | kB);
  large.options = "-cl-std=CL1.2 -DSTACK=2";
  small.instead = {large.options};
  build(large);
  Told told = build(small);
  expect(told, kA | kB, false);
  EXPECT_EQ(told.stack, 2u);
  expect(build(wanted(kA)), kA, true);  // to which nobody said that it serves
  told = build(small);
  expect(told, kA, false);
  EXPECT_EQ(told.stack, 1u);
}

TEST_P(VariantTest, TheThirdOfAFamilyIsForEverything) {
  expect(build(kA), kA, true);
  expect(build(kB), kB, true);
  expect(build(kC), kAll, true);
  expect(build(kD), kAll, false);
  expect(build(kA), kA, false);
  EXPECT_EQ(entries().size(), 3u);
}

TEST_P(VariantTest, WhoAsksForTheExactOneGetsIt) {
  build(wanted(kAll), true);
  expect(build(wanted(kA), true), kA, true);
  expect(build(wanted(kA), true), kA, false);
  build(wanted(kB), true);
  expect(build(wanted(kC), true), kC, true);
}

TEST_P(VariantTest, DamagedOnesArePassedOver) {
  build(wanted(kAll), true);
  build(wanted(kA | kB), true);
  std::ofstream(entry_of(kA | kB), std::ios::trunc) << "damaged";
  expect(build(kA), kAll, false);
  std::ofstream(entry_of(kAll), std::ios::trunc) << "damaged";
  expect(build(kA), kA, true);
}

// An entry under another's name, as a folder that was meddled with has it: its key tells.
TEST_P(VariantTest, AnEntryOfAnotherNameIsNone) {
  build(wanted(kA | kRule), true);
  const fs::path file = entry_of(kA | kRule);
  std::string name = file.filename().string();
  name.replace(16, 16, in_hex({0, kA | kB}).substr(16));
  fs::rename(file, file.parent_path() / name);
  root_.put("programs/0123456789abcdef0123456789abcdeX.program", "no entry");
  root_.put("programs/notes.program", "no entry");
  expect(build(kA), kA, true);
}

TEST_P(VariantTest, OneThatIsGoneIsNone) {
  build(kA | kB);
  for (const fs::path& file : entries()) fs::remove(file);
  expect(build(kA), kA, true);
  fs::remove_all(folder_);
  expect(build(kB), kB, true);
}

TEST_P(VariantTest, WithoutACacheThereIsNothingToFind) {
  const OpenDevice& opened = context_.opened();
  expect(run(build_variant(opened.context, opened.devices, "mask.cl", wanted(kA), {})), kA, true);
}

// Each thread has a cache of its own, as processes have.
TEST_P(VariantTest, SeveralAtOnce) {
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([this] {
      for (const std::uint64_t mask : {kA, kB, kA | kB}) EXPECT_TRUE(covers(build(mask).mask, wanted(mask)));
    });
  threads.clear();
  for (const std::uint64_t mask : {kA, kB, kA | kB}) EXPECT_FALSE(build(mask).compiled);
}

KDRAY_FOR_EACH_DEVICE(VariantTest);

}  // namespace
}  // namespace kdray::device
