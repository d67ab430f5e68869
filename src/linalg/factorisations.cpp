#include "linalg/factorisations.hpp"

namespace Eigen {

template class PartialPivLU<MatrixXd>;
template class PartialPivLU<MatrixXe>;
template class PartialPivLU<MatrixXcd>;
template class FullPivLU<MatrixXd>;
template class FullPivLU<MatrixXe>;
template class FullPivLU<MatrixXcd>;
template class ColPivHouseholderQR<MatrixXd>;
template class ColPivHouseholderQR<MatrixXe>;
template class CompleteOrthogonalDecomposition<MatrixXd>;
template class CompleteOrthogonalDecomposition<MatrixXe>;
template class JacobiSVD<MatrixXd>;
template class EigenSolver<MatrixXd>;
template class EigenSolver<MatrixXe>;
template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute<MatrixXd>(const EigenBase<MatrixXd>&, bool);
template EigenSolver<MatrixXe>& EigenSolver<MatrixXe>::compute<MatrixXe>(const EigenBase<MatrixXe>&, bool);

}  // namespace Eigen
