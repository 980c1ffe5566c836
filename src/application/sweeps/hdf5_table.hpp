// A sweep's table as an HDF5 file: one dataset for each column, named after it, with its unit and meaning as
// attributes. `run` holds 64-bit integers, `end` and `problem` text, all others doubles, NaN where a run has
// no such number. Only where the program was built with the HDF5 library.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string_view>

#include "application/sweeps/plan.hpp"

namespace impact_damper {

inline constexpr std::array<std::string_view, 3> hdf5_endings{".h5", ".hdf5", ".hdf"};
bool is_hdf5(const std::filesystem::path& table);  // by the ending of its name, in capitals or not
bool has_hdf5();                                   // whether the program was built with the library

class Hdf5Table {
 public:
  // Creates `file`. Throws IoError if it cannot be written.
  Hdf5Table(const std::filesystem::path& file, const Plan& plan);
  ~Hdf5Table();
  Hdf5Table(const Hdf5Table&) = delete;
  Hdf5Table& operator=(const Hdf5Table&) = delete;

  // Appends whole rows as row_of writes them, each with its end of line, in order.
  void add(std::string_view rows);
  void finish();  // after the last one

 private:
  struct File;
  std::unique_ptr<File> file_;
};

}  // namespace impact_damper
