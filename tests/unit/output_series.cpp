// A series at any moment: its .pvd lists frames that are whole, whatever happens to the run.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <chrono>
#include <fstream>
#include <set>
#include <thread>

#include "output/pvd.hpp"
#include "output/series.hpp"
#include "unit/output_example.hpp"

namespace barchan {
namespace {

using namespace example;

std::vector<std::string> files_in(const std::filesystem::path& directory) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(directory))
    names.insert(entry.path().filename().string());
  return {names.begin(), names.end()};
}

using Names = std::vector<std::string>;

TEST(Pvd, ReturnsTimesAndNames) {
  const TemporaryDirectory directory;
  const std::vector<SeriesWriter::Entry> entries{
      {0.0, "a_000000.vtp"}, {0.1 + 0.2, "b & <c>.vtp"}, {1e-300, "quo\"te's.vtu"}, {-1.0 / 3, "sub/d.vtp"}};
  write_pvd(directory / "s.pvd", entries);
  const auto read = read_pvd(directory / "s.pvd");
  ASSERT_EQ(read.size(), entries.size());
  for (std::size_t k = 0; k < read.size(); ++k) {
    EXPECT_EQ(read[k].time, entries[k].time);
    EXPECT_EQ(read[k].file, entries[k].file);
  }
}

TEST(Pvd, IsReadAsOthersWriteIt) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "s.pvd") << "<?xml version='1.0'?><!-- <DataSet timestep='9' file='no.vtp'/> -->\n"
                                        "<VTKFile type='Collection'><Collection>\n"
                                        "<DataSet part='0' file = 'one.vtp'\n timestep='1e-3' ></DataSet>\n"
                                        "<DataSet file='two.vtp' timestep='2'/></Collection></VTKFile>";
  const auto read = read_pvd(directory / "s.pvd");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].file, "one.vtp");
  EXPECT_EQ(read[0].time, 1e-3);
  EXPECT_EQ(read[1].file, "two.vtp");
}

TEST(Pvd, ThatIsWrongSaysWhere) {
  const TemporaryDirectory directory;
  const auto refused = [&](const std::string& text, std::initializer_list<std::string> words) {
    std::ofstream(directory / "s.pvd") << text;
    expect_output_error([&] { read_pvd(directory / "s.pvd"); }, words);
  };
  const std::string begin = "<VTKFile type=\"Collection\">\n<Collection>\n", end = "</Collection></VTKFile>";
  refused("", {"s.pvd", "whole .pvd"});
  refused(begin + "<DataSet timestep=\"0\" file=\"a.vtp\"/>", {"s.pvd", "whole .pvd"});
  refused(begin + "<DataSet timestep=\"soon\" file=\"a.vtp\"/>" + end, {"s.pvd", "line 3", "soon"});
  refused(begin + "<DataSet timestep=\"0\"/>" + end, {"s.pvd", "line 3", "'file'"});
  refused(begin + "<DataSet timestep=\"0\" file=\"a.vtp", {"s.pvd", "line 3"});
  refused(begin + "<!-- ", {"s.pvd", "line 3"});
  for (const std::string& outside : Names{"/etc/passwd", "../a.vtp", "b/../../a.vtp", ""})
    refused(begin + "<DataSet timestep=\"0\" file=\"" + outside + "\"/>" + end,
            {"s.pvd", "line 3", "file=\"" + outside + "\" is not a file below the folder of the list"});
  expect_output_error([&] { read_pvd(directory / "none.pvd"); }, {"none.pvd", "No such file"});
}

TEST(Series, ListsItsFrames) {
  const TemporaryDirectory directory;
  SeriesWriter series(directory / "new" / "run", "dune", FrameFormat::vtp, true);
  for (int k = 0; k < 5; ++k) series.write(frame(100, k));
  series.finish();
  EXPECT_EQ(series.frames(), 5);
  EXPECT_GT(series.seconds_writing(), 0.0);
  const auto entries = read_pvd(directory / "new" / "run" / "dune.pvd");
  ASSERT_EQ(entries.size(), 5u);
  for (int k = 0; k < 5; ++k) {
    const auto& entry = entries[static_cast<std::size_t>(k)];
    EXPECT_EQ(entry.time, frame(0, k).time);
    EXPECT_EQ(entry.file, "dune_00000" + std::to_string(k) + ".vtp");
    expect_same(read_frame(directory / "new" / "run" / entry.file), frame(100, k));
  }
}

TEST(Series, IsFinishedByItsDestructor) {
  const TemporaryDirectory directory;
  {
    SeriesWriter series(directory.path, "dune", FrameFormat::vtu, false);
    for (int k = 0; k < 3; ++k) series.write(frame(1000, k));
  }
  EXPECT_EQ(files_in(directory.path), (Names{"dune.pvd", "dune_000000.vtu", "dune_000001.vtu", "dune_000002.vtu"}));
  EXPECT_EQ(read_pvd(directory / "dune.pvd").size(), 3u);
}

TEST(Series, HoldsTheCallerBackWhenTwoFramesWait) {
  const TemporaryDirectory directory;
  SeriesWriter series(directory.path, "dune", FrameFormat::vtp, true);
  for (int k = 0; k < 6; ++k) {
    series.write(frame(20'000, k));
    EXPECT_GE(series.frames(), k - 1);  // at most two of the k + 1 frames handed over are not on the disk
  }
  series.finish();
  EXPECT_GT(series.seconds_waiting(), 0.0);
}

TEST(Series, GoesOnFromKeptFramesAndRemovesTheOthers) {
  const TemporaryDirectory directory;
  {
    SeriesWriter first(directory.path, "dune", FrameFormat::vtp, true);
    for (int k = 0; k < 5; ++k) first.write(frame(100, k));
  }
  for (const char* other : {"dune_000007.vtp.part", "dune_notes.vtp", "dune_12.vtp", "dunes_000001.vtp", "history.csv"})
    std::ofstream(directory / other) << "text";
  auto kept = read_pvd(directory / "dune.pvd");
  kept.resize(2);
  SeriesWriter second(directory.path, "dune", FrameFormat::vtp, true, kept);
  EXPECT_EQ(second.frames(), 2);
  EXPECT_EQ(files_in(directory.path), (Names{"dune.pvd", "dune_000000.vtp", "dune_000001.vtp", "dune_12.vtp",
                                             "dune_notes.vtp", "dunes_000001.vtp", "history.csv"}));
  EXPECT_EQ(read_pvd(directory / "dune.pvd").size(), 2u);
  second.write(frame(100, 2, /*seed=*/9));
  second.finish();
  const auto entries = read_pvd(directory / "dune.pvd");
  ASSERT_EQ(entries.size(), 3u);
  expect_same(read_frame(directory / entries[0].file), frame(100, 0));
  expect_same(read_frame(directory / entries[2].file), frame(100, 2, 9));
}

TEST(Series, WithoutKeptFramesBeginsAnew) {
  const TemporaryDirectory directory;
  { SeriesWriter(directory.path, "dune", FrameFormat::vtp, true).write(frame(10, 0)); }
  SeriesWriter again(directory.path, "dune", FrameFormat::vtu, true);
  EXPECT_EQ(files_in(directory.path), Names{});
}

TEST(Series, InADirectoryThatCannotBeIsRefusedAtOnce) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "a_file") << "text";
  const auto in = [](const std::filesystem::path& where) {
    return [=] { SeriesWriter series(where, "dune", FrameFormat::vtp, true); };
  };
  expect_output_error(in(directory / "a_file"), {"a_file"});
  expect_output_error(in(directory / "a_file" / "run"), {"a_file", "Not a directory"});
  expect_output_error(in("/proc/barchan"), {"/proc/barchan", "No such file"});
}

// The large frame does not fit; nothing after it is written, the frames before it stay.
TEST(Series, CarriesAnErrorToTheCallerAndKeepsTheFramesBefore) {
  const TemporaryDirectory directory;
  const SmallDisk small(200'000);
  SeriesWriter series(directory.path, "dune", FrameFormat::vtp, true);
  series.write(frame(100, 0));
  series.write(frame(100, 1));
  series.finish();
  series.write(frame(20'000, 2));
  series.write(frame(100, 3));  // waits while the large one fails
  expect_output_error([&] { series.finish(); }, {"dune_000002.vtp", "File too large"});
  expect_output_error([&] { series.write(frame(100, 4)); }, {"dune_000002.vtp", "File too large"});
  EXPECT_EQ(series.frames(), 2);
  EXPECT_EQ(files_in(directory.path), (Names{"dune.pvd", "dune_000000.vtp", "dune_000001.vtp"}));
  EXPECT_EQ(read_pvd(directory / "dune.pvd").size(), 2u);
}

TEST(Series, WhoseDirectoryVanishesSaysSo) {
  const TemporaryDirectory directory;
  SeriesWriter series(directory / "run", "dune", FrameFormat::vtp, true);
  std::filesystem::remove_all(directory / "run");
  expect_output_error(
      [&] {
        for (int k = 0; k < 4; ++k) series.write(frame(10, k));
        series.finish();
      },
      {"dune_000000.vtp", "No such file"});
}

// ---- kill -9 --------------------------------------------------------------------------------------------------------

constexpr std::size_t killed_particles = 5000;

// Not a test: the run that the next test kills. It is a program of its own and not a plain fork because VTK's threads
// would not survive that.
TEST(Series, DISABLED_RunToBeKilled) {
  const char* directory = std::getenv("BARCHAN_TEST_DIRECTORY");
  ASSERT_TRUE(directory);
  SeriesWriter series(directory, "dune", FrameFormat::vtp, true);
  for (int k = 0; k < 100'000; ++k) series.write(frame(killed_particles, k, static_cast<unsigned>(k)));
}

pid_t start_run(const std::filesystem::path& directory) {
  const std::string variable = "BARCHAN_TEST_DIRECTORY=" + directory.string();
  const pid_t child = fork();
  if (child == 0) {
    putenv(const_cast<char*>(variable.c_str()));
    // A runner may have divided the tests of this process: the child runs the one that it is told, whatever its share.
    unsetenv("GTEST_TOTAL_SHARDS");
    unsetenv("GTEST_SHARD_INDEX");
    execl("/proc/self/exe", "test", "--gtest_also_run_disabled_tests", "--gtest_filter=Series.DISABLED_RunToBeKilled",
          "--gtest_brief=1", nullptr);
    _exit(1);
  }
  return child;
}

/// Every frame that the .pvd lists is whole and the one it should be; returns how many.
int check_series(const std::filesystem::path& directory) {
  const auto entries = read_pvd(directory / "dune.pvd");
  Names expected{"dune.pvd"};
  int index = 0;
  for (const auto& [time, file] : entries) {
    const Frame whole = frame(killed_particles, index, static_cast<unsigned>(index));
    EXPECT_EQ(time, whole.time);
    expect_same(read_frame(directory / file), whole);
    expected.push_back(file);
    ++index;
  }
  // Beside them there is at most what was being made: one frame that has just got its name, or parts.
  int whole_but_not_listed = 0;
  for (const auto& name : files_in(directory))
    if (!name.ends_with(".part") && std::find(expected.begin(), expected.end(), name) == expected.end())
      ++whole_but_not_listed;
  EXPECT_LE(whole_but_not_listed, 1);
  return index;
}

TEST(Series, OfAKilledRunOpens) {
  using namespace std::chrono_literals;
  std::mt19937 random(std::random_device{}());
  int frames = 0;
  for (int repetition = 0; repetition < 10; ++repetition) {
    const TemporaryDirectory directory;
    const pid_t child = start_run(directory.path);
    ASSERT_GT(child, 0);
    const auto deadline = std::chrono::steady_clock::now() + 30s;
    while (!std::filesystem::exists(directory / "dune.pvd") && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(1ms);
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 60'000));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) << "the run ended by itself";
    frames += check_series(directory.path);
    // A run that begins anew removes what the killed one left half made.
    SeriesWriter again(directory.path, "dune", FrameFormat::vtp, true, read_pvd(directory / "dune.pvd"));
    for (const auto& name : files_in(directory.path)) EXPECT_FALSE(name.ends_with(".vtp.part")) << name;
  }
  EXPECT_GE(frames, 10);
}

}  // namespace
}  // namespace barchan
