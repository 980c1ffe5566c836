#include <algorithm>

#include "application/sweeps/sweep_table.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/text.hpp"

#ifdef IMPACT_DAMPER_HDF5
#include <H5Cpp.h>

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/csv.hpp"
#endif

namespace impact_damper {

bool is_hdf5(const std::filesystem::path& table) {
  return std::ranges::count(hdf5_endings, in_lower_case(table.extension().string())) > 0;
}

#ifndef IMPACT_DAMPER_HDF5

bool has_hdf5() { return false; }
void write_hdf5_table(const std::filesystem::path& file, const Plan&,
                      const std::function<void(const AddRows&)>&) {
  throw IoError(file.string() + ": cannot be written: the program was built without the HDF5 library");
}

#else

bool has_hdf5() { return true; }

namespace {

constexpr hsize_t rows_at_once = 4096;  // collected before they are written

H5::StrType text_type() {
  H5::StrType type(H5::PredType::C_S1, H5T_VARIABLE);
  type.setCset(H5T_CSET_UTF8);
  return type;
}

// A column, and its rows that are not written yet.
struct Column {
  H5::DataSet dataset;
  std::vector<std::int64_t> indices{};  // of `run`
  std::vector<double> numbers{};
  std::vector<std::string> texts{};  // of `end` and `problem`

  void write(hsize_t before, hsize_t count) {
    const H5::DataSpace memory(1, &count), file = dataset.getSpace();
    file.selectHyperslab(H5S_SELECT_SET, &count, &before);
    if (!indices.empty()) {
      dataset.write(indices.data(), H5::PredType::NATIVE_INT64, memory, file);
    } else if (!numbers.empty()) {
      dataset.write(numbers.data(), H5::PredType::NATIVE_DOUBLE, memory, file);
    } else {
      std::vector<const char*> words(texts.size());
      std::ranges::transform(texts, words.begin(), &std::string::c_str);
      dataset.write(words.data(), text_type(), memory, file);
    }
    indices.clear();
    numbers.clear();
    texts.clear();
  }
};

struct Hdf5Table {
  H5::H5File file;
  std::vector<Column> columns;
  std::vector<std::string> cells;  // of a row
  hsize_t written = 0, waiting = 0;

  Hdf5Table(const std::string& name, const Plan& plan) : file(name, H5F_ACC_TRUNC) {
    const auto rows = hsize_t(runs_of(plan));
    const H5::DataSpace space(1, &rows);
    const H5::DSetCreatPropList timeless;  // otherwise no two files would be equal
    H5Pset_obj_track_times(timeless.getId(), false);
    for (const PlanColumn& column : columns_of(plan)) {
      const bool is_text = column.name == "end" || column.name == "problem";
      const H5::DataType number(column.name == "run" ? H5::PredType::STD_I64LE : H5::PredType::IEEE_F64LE);
      const H5::DataSet dataset =
          file.createDataSet(column.name, is_text ? H5::DataType(text_type()) : number, space, timeless);
      for (const auto& [key, text] : {std::pair("unit", column.unit), std::pair("meaning", column.meaning)})
        dataset.createAttribute(key, text_type(), H5::DataSpace(H5S_SCALAR)).write(text_type(), text);
      columns.push_back({dataset});
    }
  }

  void add(std::string_view row) {
    CsvRows(row).next(cells);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::string& field = cells[i];
      if (i == 0) {
        columns[i].indices.push_back(parse_integer(field).value());
      } else if (i + 2 < columns.size()) {
        columns[i].numbers.push_back(field.empty() ? std::numeric_limits<double>::quiet_NaN()
                                                   : parse_number(field).value());
      } else {
        columns[i].texts.push_back(field);
      }
    }
    if (++waiting == rows_at_once) write();
  }

  void write() {
    if (waiting == 0) return;
    for (Column& column : columns) column.write(written, waiting);
    written += waiting;
    waiting = 0;
  }
};

}  // namespace

void write_hdf5_table(const std::filesystem::path& file, const Plan& plan,
                      const std::function<void(const AddRows&)>& produce) {
  H5::Exception::dontPrint();
  try {
    Hdf5Table table(file.string(), plan);
    produce([&](std::string_view rows) {
      while (!rows.empty()) {
        const std::size_t end = rows.find('\n');
        table.add(rows.substr(0, end));
        rows.remove_prefix(end + 1);
      }
    });
    table.write();
    table.columns.clear();
    table.file.close();
  } catch (const H5::Exception&) {  // whose message says little to users
    throw IoError(file.string() + ": cannot be written by the HDF5 library: is its disk full?");
  }
}

#endif

}  // namespace impact_damper
