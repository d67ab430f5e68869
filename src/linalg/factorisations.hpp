#pragma once
/// Eigen's factorisations, whose code for the matrices below is made once, in factorisations.cpp: each takes seconds to compile. Of most only the
/// factorisation itself: a whole class has members that nothing calls and that take longer.

#include <Eigen/Dense>

namespace Eigen {

using MatrixXe = Matrix<long double, Dynamic, Dynamic>;  ///< linalg::WideMatrix

extern template void PartialPivLU<MatrixXd>::compute();
extern template void PartialPivLU<MatrixXe>::compute();
extern template void PartialPivLU<MatrixXcd>::compute();
extern template void FullPivLU<MatrixXd>::computeInPlace();
extern template void FullPivLU<MatrixXe>::computeInPlace();
extern template void FullPivLU<MatrixXcd>::computeInPlace();
extern template void ColPivHouseholderQR<MatrixXd>::computeInPlace();
extern template void ColPivHouseholderQR<MatrixXe>::computeInPlace();
extern template void CompleteOrthogonalDecomposition<MatrixXd>::computeInPlace();
extern template void CompleteOrthogonalDecomposition<MatrixXe>::computeInPlace();
extern template void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const VectorXd& right, VectorXd& solution) const;
extern template JacobiSVD<MatrixXd>& JacobiSVD<MatrixXd>::compute(const MatrixXd& matrix, unsigned int options);
extern template class EigenSolver<MatrixXd>;
extern template class EigenSolver<MatrixXe>;
extern template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute<MatrixXd>(const EigenBase<MatrixXd>& matrix, bool with_vectors);
extern template EigenSolver<MatrixXe>& EigenSolver<MatrixXe>::compute<MatrixXe>(const EigenBase<MatrixXe>& matrix, bool with_vectors);

}  // namespace Eigen
