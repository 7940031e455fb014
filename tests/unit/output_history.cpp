#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "output/history.hpp"
#include "unit/output_example.hpp"

namespace barchan {
namespace {

using namespace example;

const std::vector<std::string> columns{"time [s]", "dt [s]", "momentum x [kg m/s]"};

std::string text_of_file(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Rows at 0, 0.1, ..., 0.4 s.
std::filesystem::path example_history(const TemporaryDirectory& directory) {
  auto file = directory / "history.csv";
  History history(file, columns);
  for (int k = 0; k < 5; ++k) history.row({0.1 * k, 1e-5, 1.0 / 3});
  return file;
}

TEST(History, HasItsColumnsAndEveryDigit) {
  const TemporaryDirectory directory;
  History history(directory / "history.csv", columns);
  history.row({0.1 + 0.2, 1e-5, -1.0 / 3});
  history.row({1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()});
  EXPECT_EQ(text_of_file(directory / "history.csv"),  // while it is still open: rows are flushed
            "time [s],dt [s],momentum x [kg m/s]\n"
            "0.30000000000000004,1.0000000000000001e-05,-0.33333333333333331\n"
            "1,nan,inf\n");
}

TEST(History, BeginsAnewUnlessToldToAppend) {
  const TemporaryDirectory directory;
  const auto file = example_history(directory);
  History history(file, columns);
  EXPECT_EQ(text_of_file(file), "time [s],dt [s],momentum x [kg m/s]\n");
}

// The row at exactly the checkpoint's time stays: the run that goes on does not write it again.
TEST(History, GoesOnAfterARestart) {
  const TemporaryDirectory directory;
  const auto file = example_history(directory);
  const std::string whole = text_of_file(file);
  const std::string up_to_2 = whole.substr(0, whole.find("\n0.3") + 1);
  { History(file, columns, /*append=*/true, /*until=*/0.1 * 2); }
  EXPECT_EQ(text_of_file(file), up_to_2);
  History history(file, columns, true, 0.1 * 2);
  for (int k = 3; k < 5; ++k) history.row({0.1 * k, 1e-5, 1.0 / 3});
  EXPECT_EQ(text_of_file(file), whole);
}

TEST(History, DropsARowThatWasCutOff) {
  const TemporaryDirectory directory;
  const auto file = example_history(directory);
  const std::string whole = text_of_file(file);
  std::filesystem::resize_file(file, file_size(file) - 3);
  { History(file, columns, true, 1.0); }
  EXPECT_EQ(text_of_file(file), whole.substr(0, whole.find("\n0.4") + 1));
}

TEST(History, ThatIsNotThereIsBegun) {
  const TemporaryDirectory directory;
  { History(directory / "history.csv", columns, true, 1.0); }
  EXPECT_EQ(text_of_file(directory / "history.csv"), "time [s],dt [s],momentum x [kg m/s]\n");
}

TEST(History, OfOtherColumnsIsNotTouched) {
  const TemporaryDirectory directory;
  const auto file = example_history(directory);
  const std::string before = text_of_file(file);
  expect_output_error([&] { History(file, {"time [s]", "energy [J]"}, true, 1.0); }, {"history.csv", "energy [J]"});
  EXPECT_EQ(text_of_file(file), before);
}

TEST(History, ThatCannotBeWrittenSaysWhy) {
  const TemporaryDirectory directory;
  expect_output_error([&] { History(directory / "nowhere" / "history.csv", columns); }, {"nowhere", "No such file"});
  History full("/dev/full", columns);
  expect_output_error([&] { full.row({0, 1, 2}); }, {"/dev/full", "No space left on device"});
}

TEST(History, RefusesARowOfTheWrongLength) {
  const TemporaryDirectory directory;
  History history(directory / "history.csv", columns);
  EXPECT_THROW(history.row({1, 2}), std::logic_error);
}

}  // namespace
}  // namespace barchan
