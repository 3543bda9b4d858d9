// What    kdray trace through the real program, with NumPy files written and read by hand: hits of known
//         answer.
#include <signal.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "apps/cli/npy_files.h"
#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "base/timer.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct HitRow {
  float t;
  std::int32_t primitive;
  float u, v;
};

std::string rays_npy(const std::vector<std::array<float, 8>>& rays) {
  return npy_of("<f4", rays);
}

std::vector<HitRow> hits_of(const std::string& bytes) {
  const std::size_t header =
      10 + static_cast<unsigned char>(bytes[8]) + 256 * static_cast<unsigned char>(bytes[9]);
  EXPECT_EQ(bytes.substr(0, 6), "\x93NUMPY");
  EXPECT_NE(bytes.find("('t', '<f4'), ('primitive', '<i4'), ('u', '<f4'), ('v', '<f4')"), std::string::npos);
  std::vector<HitRow> hits((bytes.size() - header) / sizeof(HitRow));
  if (!hits.empty()) std::memcpy(hits.data(), bytes.data() + header, hits.size() * sizeof(HitRow));
  return hits;
}

// Down on the sphere; the same with a direction of length 2; down beside it on the square; up from below the
// square but ending before it; away from everything.
const std::vector<std::array<float, 8>> kRays = {{0, 0, 5, 0, 0, 0, -1, kInfinity},
                                                 {0, 0, 5, 0, 0, 0, -2, kInfinity},
                                                 {3, 1, 5, 0, 0, 0, -1, kInfinity},
                                                 {3, 1, -5, 0, 0, 0, 1, 4},
                                                 {0, 0, 5, 0, 0, 0, 1, kInfinity}};

TEST(TraceCommand, HitsAreThoseOfTheScene) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const fs::path rays = folder.put("r.npy", rays_npy(kRays));
  const Outcome run = kdray({"trace", scene, "--rays", rays, "-o", folder / "h.npy", "--stats",
                             folder / "s.json", "--repeat", "3"});
  ASSERT_TRUE(succeeds(run));
  EXPECT_TRUE(run.out.empty());
  const std::vector<HitRow> hits = hits_of(folder.get("h.npy"));
  ASSERT_EQ(hits.size(), 5u);
  EXPECT_NEAR(hits[0].t, 3, 1e-5);
  EXPECT_EQ(hits[0].primitive, 2);
  EXPECT_NEAR(hits[1].t, 1.5, 1e-5);
  EXPECT_EQ(hits[1].primitive, 2);
  EXPECT_NEAR(hits[2].t, 5, 1e-5);
  EXPECT_TRUE(hits[2].primitive == 0 || hits[2].primitive == 1) << hits[2].primitive;
  for (const std::size_t missed : {3, 4}) {
    EXPECT_EQ(hits[missed].t, kInfinity) << missed;
    EXPECT_EQ(hits[missed].primitive, -1) << missed;
  }
  const auto stats = nlohmann::json::parse(folder.get("s.json"));
  EXPECT_EQ(stats["command"], "trace");
  EXPECT_EQ(stats["rays"]["total"], 5);
  EXPECT_EQ(stats["hits"]["hits"], 3);
  EXPECT_GT(stats["mrays_per_s"], 0.0);
  EXPECT_GT(stats["seconds"]["trace"], 0.0);
}

TEST(TraceCommand, AnyHitTellsOnlyOccluded) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const fs::path rays = folder.put("r.npy", rays_npy(kRays));
  ASSERT_TRUE(succeeds(kdray({"trace", scene, "--rays", rays, "-o", folder / "h.npy", "--any-hit", "-q"})));
  const std::vector<HitRow> hits = hits_of(folder.get("h.npy"));
  ASSERT_EQ(hits.size(), 5u);
  for (const std::size_t i : {0, 1, 2}) EXPECT_EQ(hits[i].t, 0) << i;
  for (const std::size_t i : {3, 4}) EXPECT_EQ(hits[i].t, kInfinity) << i;
}

TEST(TraceCommand, HitsGoToStdoutAsDash) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const fs::path rays = folder.put("r.npy", rays_npy(kRays));
  ASSERT_TRUE(succeeds(kdray({"trace", scene, "--rays", rays, "-o", folder / "h.npy"})));
  const Outcome run = kdray({"trace", scene, "--rays", rays, "-o", "-"});
  ASSERT_TRUE(succeeds(run));
  EXPECT_EQ(run.out, folder.get("h.npy"));
}

TEST(TraceCommand, NoRaysGiveNoHits) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const fs::path rays = folder.put("r.npy", rays_npy({}));
  ASSERT_TRUE(succeeds(kdray({"trace", scene, "--rays", rays, "-o", folder / "h.npy"})));
  EXPECT_TRUE(hits_of(folder.get("h.npy")).empty());
}

// LLVM, inside PoCL, takes hold of these signals when it compiles, and used to swallow SIGQUIT.
TEST(TraceCommand, SignalsEndItAndLeaveNothing) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const fs::path rays = folder.put("r.npy", rays_npy(kRays));
  for (const int signal : {SIGQUIT, SIGINT}) {
    // It is compiling or tracing by then; the same is to come of it at any moment.
    const Timer begun;
    const Outcome run = kdray({"trace", scene, "--rays", rays, "-o", folder / "h.npy", "--repeat", "1000000"},
                              {.signal = signal, .signal_when = [&] { return begun.seconds() > 4; }});
    EXPECT_FALSE(run.exited);
    EXPECT_EQ(run.signal, signal);
    EXPECT_EQ(folder.n_entries(), 2u);
  }
}

TEST(TraceCommand, FaultyRaysAreNamedAndLeaveNothing) {
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const auto refuses = [&](const std::string& bytes, const std::string& text) {
    const fs::path rays = folder.put("r.npy", bytes);
    return fails_with(kdray({"trace", scene, "--rays", rays, "-o", folder / "h.npy"}), 1, text);
  };
  EXPECT_TRUE(refuses("", "r.npy"));
  EXPECT_TRUE(refuses("no numbers", "r.npy"));
  EXPECT_TRUE(refuses(rays_npy(kRays).substr(0, 200), "r.npy"));
  EXPECT_TRUE(refuses(
      npy("{'descr': '<f2', 'fortran_order': False, 'shape': (1, 8), }", std::string(16, '\0')), "r.npy"));
  EXPECT_TRUE(
      refuses(npy("{'descr': '<f4', 'fortran_order': False, 'shape': (9000000000, 8), }", ""), "r.npy"));
  EXPECT_FALSE(fs::exists(folder / "h.npy"));
  EXPECT_TRUE(fails_with(kdray({"trace", scene, "--rays", folder / "none.npy", "-o", folder / "h.npy"}), 1,
                         "none.npy"));
}

TEST(TraceCommand, RaysThatAreNoneAreRefused) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const fs::path rays = folder.put("r.npy", rays_npy({{0, 0, NAN, 0, 0, 0, -1, kInfinity}}));
  EXPECT_TRUE(fails_with(kdray({"trace", scene, "--rays", rays, "-o", folder / "h.npy"}), 1,
                         rays.string() + ": ray 0"));
  EXPECT_FALSE(fs::exists(folder / "h.npy"));
}

// The same bytes as of one queue, whatever is asked.
TEST(TraceCommand, SeveralQueuesAnswerAsOneDoes) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const fs::path rays = folder.put("r.npy", rays_npy(kRays));
  for (const char* const question : {"--any-hit", "--count", "--traversal=wide", "--traversal=batch"}) {
    SCOPED_TRACE(question);
    const auto answers = [&](const char* queues) {
      EXPECT_TRUE(succeeds(
          kdray({"trace", scene, "--rays", rays, "-o", folder / "h.npy", question, "--queues", queues})));
      return folder.get("h.npy");
    };
    EXPECT_EQ(answers("1"), answers("2"));
  }
}

TEST(TraceCommand, TheRaysAreNotOverwritten) {
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const fs::path rays = folder.put("r.npy", rays_npy(kRays));
  EXPECT_TRUE(fails_with(kdray({"trace", scene, "--rays", rays, "-o", rays}), 2, "same file"));
  EXPECT_EQ(folder.get("r.npy"), rays_npy(kRays));
}

TEST(TraceCommand, TakesTextsAndPipesAndWritesCsv) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const fs::path rays = folder.put("r.csv", "0,0,5,0,0,-1\n0,0,5,0,0,1\n");
  ASSERT_TRUE(succeeds(kdray({"trace", scene, "--rays", rays, "-o", folder / "h.csv"})));
  const std::string hits = folder.get("h.csv");
  EXPECT_EQ(hits.substr(0, hits.find('\n')), "t,primitive,u,v");
  EXPECT_NE(hits.find("\ninf,-1,0,0\n"), std::string::npos);
  ASSERT_TRUE(succeeds(kdray({"trace", scene, "--rays", "-", "-o", folder / "p.csv"}, {.stdin_file = rays})));
  EXPECT_EQ(folder.get("p.csv"), hits);
  EXPECT_TRUE(fails_with(kdray({"trace", scene, "--rays", rays, "-o", folder / "h.txt"}), 2, "--output"));
  EXPECT_TRUE(
      fails_with(kdray({"trace", scene, "--rays", rays, "--all-hits", "-o", folder / "h.csv"}), 2, ".npz"));
  EXPECT_FALSE(fs::exists(folder / "h.txt"));
}

}  // namespace
}  // namespace kdray::test
