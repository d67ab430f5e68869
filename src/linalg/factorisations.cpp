#include "linalg/factorisations.hpp"

namespace Eigen {

template void PartialPivLU<MatrixXd>::compute();
template void PartialPivLU<MatrixXe>::compute();
template void PartialPivLU<MatrixXcd>::compute();
template void FullPivLU<MatrixXd>::computeInPlace();
template void FullPivLU<MatrixXe>::computeInPlace();
template void FullPivLU<MatrixXcd>::computeInPlace();
template void ColPivHouseholderQR<MatrixXd>::computeInPlace();
template void ColPivHouseholderQR<MatrixXe>::computeInPlace();
template void CompleteOrthogonalDecomposition<MatrixXd>::computeInPlace();
template void CompleteOrthogonalDecomposition<MatrixXe>::computeInPlace();
template void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const VectorXd& right, VectorXd& solution) const;
template JacobiSVD<MatrixXd>& JacobiSVD<MatrixXd>::compute(const MatrixXd& matrix, unsigned int options);
template class EigenSolver<MatrixXd>;
template class EigenSolver<MatrixXe>;
template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute<MatrixXd>(const EigenBase<MatrixXd>& matrix, bool with_vectors);
template EigenSolver<MatrixXe>& EigenSolver<MatrixXe>::compute<MatrixXe>(const EigenBase<MatrixXe>& matrix, bool with_vectors);

}  // namespace Eigen
