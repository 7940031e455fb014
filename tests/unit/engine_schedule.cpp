// The schedule executes what it was given, in the order of its stages; a task that touches what it did not declare is
// found in builds with assertions.
#include "engine/schedule.hpp"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>

#include "engine/phase_records.hpp"
#include "state/particles.hpp"

namespace barchan {
namespace {

constexpr std::array<const char*, 3> stages{"first", "second", "third"};

TEST(Schedule, RunsTasksByStageThenInTheOrderOfAdding) {
  Schedule s(stages);
  std::string done;
  s.add({2, "b", {}, [&] { done += "c"; }});
  s.add({0, "a", {}, [&] { done += "a"; }});
  s.add({0, "b", {}, [&] { done += "b"; }});
  s.run(0, 2);
  EXPECT_EQ(done, "abc");
  s.run(0, 0);
  EXPECT_EQ(done, "abcab");
  EXPECT_EQ(s.executed(), (std::vector<long>{2, 0, 1})) << "a stage without tasks is never executed";
}

TEST(Schedule, CallsARepeatAsOftenAsItSaysAndCountsIt) {
  Schedule s(stages);
  std::string done;
  long times = 3;
  s.add({0, "sand", {}, [&] { done += "a"; }});
  s.add({0, "sand", {}, [&] { done += "b"; }, Repeat{"steps of contacts", 1e-6, [&] { return times; }}});
  s.add({0, "sand", {}, [&] { done += "c"; }});
  s.run(0, 0);
  times = 0;
  s.run(0, 0);
  EXPECT_EQ(done, "abbbcac");
  ASSERT_EQ(s.repeats().size(), 1u);
  const RepeatCount& r = s.repeats()[0];
  EXPECT_EQ(r.calls, 3);
  EXPECT_EQ(r.name, "steps of contacts");
  EXPECT_EQ(r.owner, "sand");
  EXPECT_EQ(r.interval, 1e-6);
  EXPECT_GE(r.seconds, 0.0);
}

TEST(Schedule, FindsATaskThatTouchesWhatItDidNotDeclare) {
#ifdef NDEBUG
  GTEST_SKIP() << "checked in builds with assertions";
#endif
  PhaseParticles p("air", 2, 3, 1.0, 0);
  p.add(Field::position);
  p.add(Field::velocity);
  Schedule s(stages);
  s.add({0, "air", {{"air", {Field::position}, {}}}, [&] { (void)p.column(Field::position); }});
  s.add({1, "air", {{"air", {Field::position}, {}}, {"sand", {Field::velocity}, {}}}, [&] {
           (void)p.column(Field::velocity);
         }});
  EXPECT_NO_THROW(s.run(0, 0));
  EXPECT_THROW(s.run(1, 1), std::logic_error);
  EXPECT_NO_THROW((void)p.column(Field::velocity)) << "outside of tasks all is free";
}

/// Notes what is asked of it.
class Notes : public Halo {
 public:
  void fill_images(std::size_t phase, Record record) override { text += " fill " + what(phase, record); }
  void outdate_images(std::size_t phase, Record record) override { text += " old " + what(phase, record); }
  std::string text;

 private:
  static std::string what(std::size_t phase, Record record) { return std::to_string(phase) + name_of(record); }
};

TEST(Schedule, HasTheImagesMadeThatATaskReadsRightBeforeIt) {
  Schedule s(stages);
  Notes halo;
  s.add({0, "air", {{"air", {}, {}, {{}, {}, {Record::motion}}}}, [&] { halo.text += " pack"; }});
  s.add({1, "sand", {{"sand", {}, {}, {{Record::motion}, {}, {}}}, {"air", {}, {}, {{}, {Record::motion}, {}}}}, [&] {
           halo.text += " push";
         }});
  s.use(halo, {"sand", "air"});
  s.run(0, 2);
  EXPECT_EQ(halo.text, " pack old 1motion fill 1motion push") << "what a task reads of particles alone needs no images";
  s.add({2, "snow", {{"snow", {}, {}, {{}, {Record::stress}, {}}}}, [] {}});
  EXPECT_THROW(s.use(halo, {"sand", "air"}), std::logic_error);
}

TEST(Schedule, FindsATaskThatReadsRecordsWhichItDidNotDeclare) {
#ifdef NDEBUG
  GTEST_SKIP() << "checked in builds with assertions";
#endif
  PhaseRecords air("air", 2);
  air.make(Record::motion);
  air.fit(3, 2);
  const RecordArray& records = air.array(Record::motion);
  const auto read = [&](const RecordTouch& touch, std::size_t k) {
    Schedule s(stages);
    s.add({0, "air", {{"air", {}, {}, touch}}, [&records, k] { (void)records[k]; }});
    s.run(0, 0);
  };
  EXPECT_NO_THROW(read({{Record::motion}, {}, {}}, 2));
  EXPECT_THROW(read({{Record::stress}, {}, {}}, 2), std::logic_error);
  EXPECT_THROW(read({{Record::motion}, {}, {}}, 3), std::logic_error) << "the first image";
  EXPECT_THROW(read({{}, {Record::motion}, {}}, 3), std::logic_error) << "nobody has made the images";
  EXPECT_NO_THROW((void)records[3]) << "outside of tasks all is free";
}

}  // namespace
}  // namespace barchan
