// Reading a buffer back piece by piece, on devices that could also map it: every byte, in order, whatever the
// pieces.
#include "device/opencl/read_back.h"

#include <gtest/gtest.h>

#include <numeric>
#include <span>
#include <stdexcept>
#include <vector>

#include "support/device.h"

namespace kdray::device {
namespace {

class ReadBackTest : public test::EachDevice {
 protected:
  ReadBackTest() : context_(GetParam(), 1), queue_(context_.queues().front()), words_(3'000'001) {
    std::iota(words_.begin(), words_.end(), 7u);
    buffer_ = context_.upload_copy(words_.data(), words_.size() * 4, "words");
  }

  Context context_;
  cl::CommandQueue queue_;
  std::vector<cl_uint> words_;
  cl::Buffer buffer_;
};

TEST_P(ReadBackTest, PiecesInTurnOfAnySizes) {
  const std::vector<Piece> pieces = {{0, 4}, {4, 8'000'000}, {8'000'004, 12}, {400, 4'000'000}};
  std::size_t next = 0;
  read_pieces(context_, queue_, buffer_, pieces, [&](std::size_t i, const void* memory) {
    EXPECT_EQ(i, next++);
    const auto* read = static_cast<const cl_uint*>(memory);
    EXPECT_TRUE(
        std::equal(read, read + pieces[i].n / 4, words_.begin() + static_cast<long>(pieces[i].first / 4)));
  });
  EXPECT_EQ(next, pieces.size());
}

TEST_P(ReadBackTest, WhoLooksMayThrow) {
  const std::vector<Piece> pieces(5, Piece{0, 1 << 20});
  int n = 0;
  const auto throws = [&](std::size_t, const void*) {
    if (++n == 2) throw std::runtime_error("enough");
  };
  EXPECT_THROW(read_pieces(context_, queue_, buffer_, pieces, throws), std::runtime_error);
  EXPECT_EQ(n, 2);
  bool read = false;
  read_pieces(context_, queue_, buffer_, std::span(pieces).first(1),
              [&](std::size_t, const void* memory) { read = *static_cast<const cl_uint*>(memory) == 7u; });
  EXPECT_TRUE(read);
}

KDRAY_FOR_EACH_DEVICE(ReadBackTest);

}  // namespace
}  // namespace kdray::device
