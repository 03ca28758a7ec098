; A lift takes passengers from the floor they wait on to the floor they want.
;@ skill board 0 board ?p
;@ skill depart 0 depart ?p
;@ skill up 0 up ?to
;@ skill down 0 down ?to
(define (domain miconic)
 (:requirements :strips :typing)
 (:types passenger floor)
 (:predicates (origin ?p - passenger ?f - floor) (destination ?p - passenger ?f - floor) (above ?low ?high - floor)
  (boarded ?p - passenger) (served ?p - passenger) (lift-at ?f - floor))
 (:action board
  :parameters (?f - floor ?p - passenger)
  :precondition (and (lift-at ?f) (origin ?p ?f))
  :effect (and (boarded ?p)))
 (:action depart
  :parameters (?f - floor ?p - passenger)
  :precondition (and (lift-at ?f) (destination ?p ?f) (boarded ?p))
  :effect (and (served ?p) (not (boarded ?p))))
 (:action up
  :parameters (?from ?to - floor)
  :precondition (and (lift-at ?from) (above ?from ?to))
  :effect (and (lift-at ?to) (not (lift-at ?from))))
 (:action down
  :parameters (?from ?to - floor)
  :precondition (and (lift-at ?from) (above ?to ?from))
  :effect (and (lift-at ?to) (not (lift-at ?from)))))
