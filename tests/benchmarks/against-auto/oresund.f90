! Averaged superharmonic response (n = 2) of the longest Oresund stay for AUTO-07p: the field of models/superharmonic.hpp, written again from
! its equations, with exact derivatives.
!
!   U(1:4) = u1, v1, u2, v2 [m],  Z1 = u1 + i v1, Z2 = u2 + i v2;  PAR(1) = omega [rad/s]
!
! oresund.inc, printed by `against coefficients`: w1, w2, zeta1, zeta2, K, L, sag_ratio, theta, support, a2, c2, G1..G4, first(5).

module oresund
  implicit none
  include 'oresund.inc'
  double precision, parameter :: n = 2d0
  double precision, parameter :: gamma1 = 0.75d0 * K / L**2 * G1, gamma2 = 0.25d0 * K / L**2 * G2
  double precision, parameter :: gamma3 = 0.25d0 * K / L**2 * G3, gamma4 = 0.75d0 * K / L**2 * G4
  double precision, parameter :: beta = 0.5d0 * K * support / L * cos(theta) * c2
  double precision, parameter :: inertia = support * a2 * sin(theta), stretch = 16d0 * support * a2 * sag_ratio * K * cos(theta)
contains
  ! Z = zr + i zi in the wind of the other mode Y = yr + i yi:
  !   2 n omega (Z' + rate Z) = i [ (d + a |Z|^2 + 2 b |Y|^2) Z + b Y^2 conj(Z) + er + i ei ]
  ! j: columns zr, zi, yr, yi, omega; dd, der, dei: slopes in omega of d, er, ei.
  subroutine mode(zr, zi, yr, yi, omega, rate, a, b, d, dd, er, der, ei, dei, ijac, f, j)
    double precision, intent(in) :: zr, zi, yr, yi, omega, rate, a, b, d, dd, er, der, ei, dei
    integer, intent(in) :: ijac
    double precision, intent(out) :: f(2), j(2, 5)
    double precision :: m, s, t, scale
    scale = 1d0 / (2d0 * n * omega)
    m = d + a * (zr**2 + zi**2) + 2d0 * b * (yr**2 + yi**2)
    s = b * (yr**2 - yi**2)
    t = 2d0 * b * yr * yi
    f(1) = scale * (-m * zi - t * zr + s * zi - ei)
    f(2) = scale * (m * zr + s * zr + t * zi + er)
    if (ijac /= 0) then
      j(1, 1) = scale * (-2d0 * a * zr * zi - t) - rate
      j(1, 2) = scale * (-m - 2d0 * a * zi**2 + s)
      j(1, 3) = scale * b * (-4d0 * yr * zi - 2d0 * yi * zr + 2d0 * yr * zi)
      j(1, 4) = scale * b * (-4d0 * yi * zi - 2d0 * yr * zr - 2d0 * yi * zi)
      j(1, 5) = scale * (-dd * zi - dei) - f(1) / omega
      j(2, 1) = scale * (m + 2d0 * a * zr**2 + s)
      j(2, 2) = scale * (2d0 * a * zr * zi + t) - rate
      j(2, 3) = scale * b * (4d0 * yr * zr + 2d0 * yr * zr + 2d0 * yi * zi)
      j(2, 4) = scale * b * (4d0 * yi * zr - 2d0 * yi * zr + 2d0 * yr * zi)
      j(2, 5) = scale * (dd * zr + der) - f(2) / omega
    end if
    f = f - rate * (/ zr, zi /)
  end subroutine mode
end module oresund

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  use oresund
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision :: omega, x, y, q, dq, force, scale, dscale, z0r, dz0r, z0i, dz0i, zz, dzz, detuning, ddetuning, j(2, 5)

  ! Z0 = F2 / (w2^2 - omega^2 + 2 i zeta2 w2 omega), the frozen linear response
  omega = par(1)
  x = w2**2 - omega**2
  y = 2d0 * zeta2 * w2 * omega
  q = x**2 + y**2
  dq = -4d0 * omega * x + 4d0 * zeta2 * w2 * y
  force = inertia * omega**2 - stretch
  scale = force / q
  dscale = (2d0 * inertia * omega - scale * dq) / q
  z0r = scale * x
  dz0r = dscale * x - 2d0 * omega * scale
  z0i = -scale * y
  dz0i = -dscale * y - 2d0 * zeta2 * w2 * scale
  zz = z0r**2 + z0i**2
  dzz = 2d0 * (z0r * dz0r + z0i * dz0i)

  detuning = w1**2 - (n * omega)**2 + 2d0 * gamma2 * zz
  ddetuning = -2d0 * n**2 * omega + 2d0 * gamma2 * dzz
  call mode(u(1), u(2), u(3), u(4), omega, zeta1 * w1, gamma1, gamma2, detuning, ddetuning, 0d0, 0d0, 0d0, 0d0, ijac, f(1:2), j)
  if (ijac /= 0) then
    dfdu(1:2, 1:4) = j(:, 1:4)
    if (ijac == 2) dfdp(1:2, 1) = j(:, 5)
  end if

  detuning = w2**2 - (n * omega)**2 + 2d0 * gamma4 * zz
  ddetuning = -2d0 * n**2 * omega + 2d0 * gamma4 * dzz
  call mode(u(3), u(4), u(1), u(2), omega, zeta2 * w2, gamma4, gamma3, detuning, ddetuning, beta * z0r, beta * dz0r, beta * z0i, beta * dz0i, &
            ijac, f(3:4), j)
  if (ijac /= 0) then
    dfdu(3:4, 3:4) = j(:, 1:2)
    dfdu(3:4, 1:2) = j(:, 3:4)
    if (ijac == 2) dfdp(3:4, 1) = j(:, 5)
  end if
end subroutine func

subroutine stpnt(ndim, u, par, t)
  use oresund
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  u(1:4) = first(1:4)
  par(1) = first(5)
end subroutine stpnt

subroutine bcnd
end subroutine bcnd

subroutine icnd
end subroutine icnd

subroutine fopt
end subroutine fopt

subroutine pvls
end subroutine pvls
