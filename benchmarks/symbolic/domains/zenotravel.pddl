; Aircraft take people between cities and burn one level of fuel a flight.
;@ skill board 0 board ?p ?a
;@ skill debark 0 debark ?p
;@ skill fly 0 fly ?a ?to
;@ skill refuel 0 refuel ?a
(define (domain zenotravel)
 (:requirements :strips :typing)
 (:types city level traveller - object person aircraft - traveller)
 (:predicates (at ?x - traveller ?c - city) (in ?p - person ?a - aircraft) (fuel ?a - aircraft ?l - level)
  (next ?l ?more - level))
 (:action board
  :parameters (?p - person ?a - aircraft ?c - city)
  :precondition (and (at ?p ?c) (at ?a ?c))
  :effect (and (in ?p ?a) (not (at ?p ?c))))
 (:action debark
  :parameters (?p - person ?a - aircraft ?c - city)
  :precondition (and (in ?p ?a) (at ?a ?c))
  :effect (and (at ?p ?c) (not (in ?p ?a))))
 (:action fly
  :parameters (?a - aircraft ?from ?to - city ?l ?less - level)
  :precondition (and (at ?a ?from) (fuel ?a ?l) (next ?less ?l))
  :effect (and (at ?a ?to) (fuel ?a ?less) (not (at ?a ?from)) (not (fuel ?a ?l))))
 (:action refuel
  :parameters (?a - aircraft ?c - city ?l ?more - level)
  :precondition (and (at ?a ?c) (fuel ?a ?l) (next ?l ?more))
  :effect (and (fuel ?a ?more) (not (fuel ?a ?l)))))
