! Periodic motions of the longest Oresund stay for AUTO-07p: the modal equations with the reduced coupling, written again from the header of
! models/nielsen_kirkegaard.hpp, made autonomous by an oscillator whose limit cycle is (cos, sin) omega t; exact derivatives.
!
!   U(1:6) = q1, q1', q2, q2', c, s;  PAR(1) = omega [rad/s], PAR(2) = support amplitude [m], PAR(11) = period [s]
!
! oresund.inc is printed by `against coefficients`.

module stay
  implicit none
  include 'oresund.inc'
  double precision, parameter :: pi = 3.14159265358979324d0, c1 = pi**2
end module stay

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  use stay
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision :: omega, amplitude, e, load, r2, k2, q1, q2, c, s

  omega = par(1)
  amplitude = par(2)
  q1 = u(1)
  q2 = u(3)
  c = u(5)
  s = u(6)
  k2 = K / L**2
  e = K * amplitude / L * cos(theta)
  load = a2 * (omega**2 * sin(theta) - 16d0 * sag_ratio * K * cos(theta))
  r2 = c**2 + s**2
  f(1) = u(2)
  f(2) = -2d0 * zeta1 * w1 * u(2) - w1**2 * q1 - e * c1 * c * q1 - k2 * (G1 * q1**2 + G2 * q2**2) * q1
  f(3) = u(4)
  f(4) = -2d0 * zeta2 * w2 * u(4) - w2**2 * q2 - e * c2 * c * q2 - k2 * (G3 * q1**2 + G4 * q2**2) * q2 + amplitude * load * c
  f(5) = c - omega * s - c * r2
  f(6) = s + omega * c - s * r2
  if (ijac == 0) return
  dfdu = 0d0
  dfdu(1, 2) = 1d0
  dfdu(2, 1) = -w1**2 - e * c1 * c - k2 * (3d0 * G1 * q1**2 + G2 * q2**2)
  dfdu(2, 2) = -2d0 * zeta1 * w1
  dfdu(2, 3) = -2d0 * k2 * G2 * q1 * q2
  dfdu(2, 5) = -e * c1 * q1
  dfdu(3, 4) = 1d0
  dfdu(4, 1) = -2d0 * k2 * G3 * q1 * q2
  dfdu(4, 3) = -w2**2 - e * c2 * c - k2 * (G3 * q1**2 + 3d0 * G4 * q2**2)
  dfdu(4, 4) = -2d0 * zeta2 * w2
  dfdu(4, 5) = -e * c2 * q2 + amplitude * load
  dfdu(5, 5) = 1d0 - r2 - 2d0 * c**2
  dfdu(5, 6) = -omega - 2d0 * c * s
  dfdu(6, 5) = omega - 2d0 * c * s
  dfdu(6, 6) = 1d0 - r2 - 2d0 * s**2
  if (ijac == 1) return
  dfdp(:, 1:2) = 0d0
  dfdp(4, 1) = amplitude * a2 * 2d0 * omega * sin(theta) * c
  dfdp(5, 1) = -s
  dfdp(6, 1) = c
  dfdp(2, 2) = -K / L * cos(theta) * c1 * c * q1
  dfdp(4, 2) = -K / L * cos(theta) * c2 * c * q2 + load * c
end subroutine func

! No support motion: rest, at omega = 1.4 rad/s.
subroutine stpnt(ndim, u, par, t)
  use stay
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  par(1) = 1.4d0
  par(2) = 0d0
  par(11) = 2d0 * pi / par(1)
  u(1:4) = 0d0
  u(5) = cos(2d0 * pi * t)
  u(6) = sin(2d0 * pi * t)
end subroutine stpnt

subroutine bcnd
end subroutine bcnd

subroutine icnd
end subroutine icnd

subroutine fopt
end subroutine fopt

subroutine pvls
end subroutine pvls
