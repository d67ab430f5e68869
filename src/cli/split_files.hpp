#pragma once
/// The files of --split: for out.csv those of the runs, out.1.csv, out.2.csv, …, and their table, out.runs.csv.

#include <cstddef>
#include <string>

namespace pwlsim::cli {

/// Standard output ("-"), a pipe or a device: it takes one table, and no file stands beside it.
[[nodiscard]] bool takes_one_table(const std::string& output);
/// As a message names it.
[[nodiscard]] std::string table_name(const std::string& output);
/// `run`: from 0.
[[nodiscard]] std::string split_file(const std::string& output, std::size_t run);
/// out.pss.csv for out.csv: the rows of the steady state, if .tran has rows too. A stream is its own.
[[nodiscard]] std::string orbit_file_name(const std::string& output);
/// out.ac.csv for out.csv: small signals. A stream is its own.
[[nodiscard]] std::string small_signal_file_name(const std::string& output);
/// The file of the derivatives of .sens.
[[nodiscard]] std::string sensitivity_file_name(const std::string& output);
/// out.ac.svg for out.svg: the picture of small signals.
[[nodiscard]] std::string bode_file_name(const std::string& plot);
/// Always CSV, for any format of the rows.
[[nodiscard]] std::string split_table(const std::string& output);
/// Whether `name` is that table or one of the files, for any number of runs.
[[nodiscard]] bool is_split_file(const std::string& output, const std::string& name);

}  // namespace pwlsim::cli
