#pragma once
/// The files of --split: of out.csv those of the runs, out.1.csv, out.2.csv, …, and the table of them, out.runs.csv.

#include <cstddef>
#include <string>

namespace pwlsim::cli {

/// `run`: from 0.
[[nodiscard]] std::string split_file(const std::string& output, std::size_t run);
/// Of out.csv out.pss.csv: the rows of the steady state, beside those of .tran.
[[nodiscard]] std::string orbit_file_name(const std::string& output);
/// Of out.csv out.ac.csv: small signals.
[[nodiscard]] std::string small_signal_file_name(const std::string& output);
/// That of the derivatives of .sens.
[[nodiscard]] std::string sensitivity_file_name(const std::string& output);
/// Of out.svg out.ac.svg: their picture.
[[nodiscard]] std::string bode_file_name(const std::string& plot);
/// CSV, whatever the format of the rows.
[[nodiscard]] std::string split_table(const std::string& output);
/// Whether `name` is that table or, of however many runs, one of the files.
[[nodiscard]] bool is_split_file(const std::string& output, const std::string& name);

}  // namespace pwlsim::cli
