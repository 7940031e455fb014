// Images of records: copies of their sources, moved by periods, made when they are asked for and the records are newer.
#include "engine/phase_records.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace barchan {
namespace {

/// Three particles in a periodic square of 1 m; the first stands at its left side.
class Halos : public ::testing::Test {
 protected:
  Halos() : air_("air", 2, 3, 1.0, 0), grid_(bounds_, 0.25, 0.25, Blocks{}), records_("air", 2) {
    air_.add(Field::position);
    const double x[] = {0.05, 0.5, 0.6}, y[] = {0.5, 0.4, 0.7};
    std::copy_n(x, 3, air_.column(Field::position, 0));
    std::copy_n(y, 3, air_.column(Field::position, 1));
    grid_.sort(air_);
  }
  /// The image of the particle with id 0 beyond the right side.
  std::size_t beyond() const {
    const auto& images = grid_.image_list();
    for (std::size_t q = 0; q < images.size(); ++q)
      if (air_.id()[images[q].source] == 0 && images[q].shift[0] == 1 && images[q].shift[1] == 0) return 3 + q;
    return 0;
  }
  std::size_t first() const {
    return static_cast<std::size_t>(std::find(air_.id().begin(), air_.id().end(), 0) - air_.id().begin());
  }

  Bounds bounds_{2, {0, 0, 0}, {1, 1, 0}, {true, true, false}};
  PhaseParticles air_;
  CellGrid grid_;
  PhaseRecords records_;
};

TEST_F(Halos, CopyTheirSourceWhenTheRecordsAreNewer) {
  ASSERT_GT(beyond(), 0u);
  records_.make(Record::motion);
  records_.fit(3, grid_.images());
  RecordArray& motion = records_.array(Record::motion);
  double* r = motion[first()];
  r[0] = 0.05, r[1] = 0.5, r[2] = 7.0;
  records_.fill_images(Record::motion, air_, grid_);
  EXPECT_DOUBLE_EQ(motion[beyond()][0], 1.05);
  EXPECT_DOUBLE_EQ(motion[beyond()][1], 0.5);
  EXPECT_DOUBLE_EQ(motion[beyond()][2], 7.0);
  r[2] = 8.0;
  records_.fill_images(Record::motion, air_, grid_);
  EXPECT_DOUBLE_EQ(motion[beyond()][2], 7.0) << "nobody said that the records are newer";
  records_.outdate_images(Record::motion);
  records_.fill_images(Record::motion, air_, grid_);
  EXPECT_DOUBLE_EQ(motion[beyond()][2], 8.0);
  r[2] = 9.0;
  records_.fit(3, grid_.images());
  records_.fill_images(Record::motion, air_, grid_);
  EXPECT_DOUBLE_EQ(motion[beyond()][2], 9.0) << "after a search all images are old";
}

TEST_F(Halos, OfEveryKindOfRecords) {
  for (const Record record : {Record::extended, Record::stress, Record::artificial, Record::carried}) {
    EXPECT_FALSE(records_.has(record)) << name_of(record);
    EXPECT_NO_THROW(records_.fill_images(record, air_, grid_)) << "records that nobody made have none";
    records_.make(record);
    records_.fit(3, grid_.images());
    RecordArray& array = records_.array(record);
    array[first()][0] = 0.05;
    array[first()][3] = 4.0;
    records_.fill_images(record, air_, grid_);
    EXPECT_DOUBLE_EQ(array[beyond()][0], record == Record::artificial ? 0.05 : 1.05) << name_of(record);
    EXPECT_DOUBLE_EQ(array[beyond()][3], 4.0) << name_of(record);
  }
  EXPECT_THROW(records_.make(Record::compact), std::logic_error);
  records_.make_compact(bounds_);
  records_.make(Record::eddies);
  records_.fit(3, grid_.images());
  records_.compact()->write<2>(first(), {0.05, 0.5}, {3.0, 0.0}, 5.0, 1.0);
  records_.eddies().root[first()] = 6.0;
  records_.fill_images(Record::compact, air_, grid_);
  records_.fill_images(Record::eddies, air_, grid_);
  EXPECT_EQ((*records_.compact())[beyond()][2], 3.0f);
  EXPECT_EQ((*records_.compact())[beyond()][4], 5.0f);
  EXPECT_EQ(records_.eddies().root[beyond()], 6.0);
}

}  // namespace
}  // namespace barchan
