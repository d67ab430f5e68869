#pragma once
/// Eigen's factorisations, whose code for the matrices below is made once, in factorisations.cpp: each takes seconds to compile.

#include <Eigen/Dense>

namespace Eigen {

using MatrixXe = Matrix<long double, Dynamic, Dynamic>;  ///< linalg::WideMatrix

extern template class PartialPivLU<MatrixXd>;
extern template class PartialPivLU<MatrixXe>;
extern template class PartialPivLU<MatrixXcd>;
extern template class FullPivLU<MatrixXd>;
extern template class FullPivLU<MatrixXe>;
extern template class FullPivLU<MatrixXcd>;
extern template class ColPivHouseholderQR<MatrixXd>;
extern template class ColPivHouseholderQR<MatrixXe>;
extern template class CompleteOrthogonalDecomposition<MatrixXd>;
extern template class CompleteOrthogonalDecomposition<MatrixXe>;
extern template class JacobiSVD<MatrixXd>;
extern template class EigenSolver<MatrixXd>;
extern template class EigenSolver<MatrixXe>;
extern template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute<MatrixXd>(const EigenBase<MatrixXd>& matrix, bool with_vectors);
extern template EigenSolver<MatrixXe>& EigenSolver<MatrixXe>::compute<MatrixXe>(const EigenBase<MatrixXe>& matrix, bool with_vectors);

}  // namespace Eigen
