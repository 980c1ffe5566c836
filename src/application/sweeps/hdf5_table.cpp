#include "application/sweeps/hdf5_table.hpp"

#include <algorithm>

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
#endif

namespace impact_damper {

bool is_hdf5(const std::filesystem::path& table) {
  return std::ranges::count(hdf5_endings, in_lower_case(table.extension().string())) > 0;
}

#ifndef IMPACT_DAMPER_HDF5

bool has_hdf5() { return false; }
struct Hdf5Table::File {};
Hdf5Table::Hdf5Table(const std::filesystem::path& file, const Plan&) {
  throw IoError(file.string() + ": cannot be written: the program was built without the HDF5 library");
}
Hdf5Table::~Hdf5Table() = default;
void Hdf5Table::add(std::string_view) {}
void Hdf5Table::finish() {}

#else

bool has_hdf5() { return true; }

namespace {

constexpr hsize_t rows_at_once = 4096;  // collected before they are written

// Returns the next field of a row, without its quotes, and reduces `row` to what follows.
std::string next_field(std::string_view& row) {
  std::string field;
  bool quoted = false;
  std::size_t i = 0;
  for (; i < row.size() && (quoted || row[i] != ','); ++i) {
    if (row[i] != '"') {
      field += row[i];
    } else if (quoted && i + 1 < row.size() && row[i + 1] == '"') {
      field += row[++i];
    } else {
      quoted = !quoted;
    }
  }
  row.remove_prefix(std::min(row.size(), i + 1));
  return field;
}

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

}  // namespace

struct Hdf5Table::File {
  std::string name;
  H5::H5File file;
  std::vector<Column> columns;
  hsize_t written = 0, waiting = 0;

  static H5::H5File made(const std::string& name) {
    H5::Exception::dontPrint();
    return {name, H5F_ACC_TRUNC};
  }
  File(const std::filesystem::path& path, const Plan& plan) : name(path.string()), file(made(name)) {
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
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::string field = next_field(row);
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

  // Replaces the library's message about a failure, which tells users little.
  template <class Act>
  static void guarded(const std::string& name, Act act) {
    try {
      act();
    } catch (const H5::Exception&) {
      throw IoError(name + ": cannot be written by the HDF5 library: is its disk full?");
    }
  }
};

Hdf5Table::Hdf5Table(const std::filesystem::path& file, const Plan& plan) {
  File::guarded(file.string(), [&] { file_ = std::make_unique<File>(file, plan); });
}

Hdf5Table::~Hdf5Table() = default;

void Hdf5Table::add(std::string_view rows) {
  File::guarded(file_->name, [&] {
    while (!rows.empty()) {
      const std::size_t end = rows.find('\n');
      file_->add(rows.substr(0, end));
      rows.remove_prefix(end + 1);
    }
  });
}

void Hdf5Table::finish() {
  File::guarded(file_->name, [&] {
    file_->write();
    file_->columns.clear();
    file_->file.close();
  });
}

#endif

}  // namespace impact_damper
